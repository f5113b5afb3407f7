#include "core/protocol/families/registry.hpp"

#include <gtest/gtest.h>

#include <set>

namespace fieldcast::test {
namespace {

TEST(Registry, EveryProtocolIsFoundByItsName) {
  std::set<std::string_view> names;
  for (const ProtocolEntry& entry : protocols()) {
    EXPECT_EQ(find_protocol(entry.name), &entry);
    EXPECT_FALSE(entry.summary.empty());
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " twice";
  }
  EXPECT_TRUE(names.contains("modbus-rtu"));
  EXPECT_TRUE(names.contains("modbus-ascii"));
  EXPECT_TRUE(names.contains("modbus-tcp"));
  EXPECT_EQ(find_protocol("modbus"), nullptr);
}

TEST(Registry, AProtocolKnowsItsOwnNameAndAreas) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1});
    ASSERT_TRUE(made.has_value()) << entry.name << ": " << made.error().what;
    EXPECT_EQ((*made)->traits().name, entry.name);
    EXPECT_FALSE((*made)->areas().empty());
    for (const Area& area : (*made)->areas()) {
      EXPECT_GT(area.items, 0u);
      EXPECT_TRUE(area.item_bits == 1 || area.item_bits == 8 || area.item_bits == 16 ||
                  area.item_bits == 32 || area.item_bits == 64);
    }
  }
}

TEST(Registry, EveryRefusalHasWords) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1});
    ASSERT_TRUE(made.has_value()) << entry.name;
    const auto codes = (*made)->traits().codes;
    // A NAK of the FX has no code.
    EXPECT_EQ(codes.empty(), entry.name == "mitsubishi-fx") << entry.name;
    std::set<std::uint16_t> known;
    for (const DeviceCode& row : codes) {
      EXPECT_FALSE(row.text.empty()) << entry.name << ' ' << row.code;
      EXPECT_TRUE(known.insert(row.code).second) << entry.name << ' ' << row.code << " twice";
    }
  }
}

TEST(DeviceCode, IsHexadecimalWithItsWords) {
  static constexpr DeviceCode kCodes[] = {{0x02, "illegal data address"},
                                          {0x1103, "start address out of range"},
                                          {0x2100, "write refused"}};
  EXPECT_EQ(device_code_words(kCodes, 2), "02 illegal data address");
  EXPECT_EQ(device_code_words(kCodes, 0x1103), "1103 start address out of range");
  EXPECT_EQ(device_code_words(kCodes, 0x2108), "2108 write refused");
  EXPECT_EQ(device_code_words(kCodes, 0x5A), "code 5A");
  EXPECT_EQ(device_code_note(kCodes, 2), " (02 illegal data address)");
  EXPECT_EQ(device_code_note(kCodes, 0), "");
}

TEST(DeviceCode, FinsAndItsFrameHaveOneTable) {
  const auto made =
      find_protocol("omron-hostlink")->make({.address = 0, .options = {{"mode", "fins"}}});
  ASSERT_TRUE(made.has_value());
  const auto codes = (*made)->traits().codes;
  EXPECT_EQ(device_code_words(codes, 0x14), "14 format error");
  EXPECT_EQ(device_code_words(codes, 0x1101), "1101 no such memory area");
  EXPECT_EQ(device_code_words(codes, 0x2103), "2103 write refused");
}

TEST(DeviceCode, ACodeOrItsClassSaysWhatItMeansForTheNextRead) {
  const auto fins =
      find_protocol("omron-hostlink")->make({.address = 0, .options = {{"mode", "fins"}}});
  ASSERT_TRUE(fins.has_value());
  const auto codes = (*fins)->traits().codes;
  EXPECT_EQ(device_code_cause(codes, 0x1103), Cause::kDeviceError);
  EXPECT_EQ(device_code_cause(codes, 0x2201), Cause::kDeviceBusy);
  EXPECT_EQ(device_code_cause(codes, 0x2204), Cause::kDeviceBusy) << "of the class 22xx";
  EXPECT_EQ(device_code_cause(codes, 0x0205), Cause::kDeviceBusy);
  EXPECT_EQ(device_code_cause(codes, 0x2104), Cause::kDeviceError);
  EXPECT_EQ(device_code_cause(codes, 0x13), Cause::kChecksum);
  EXPECT_EQ(device_code_cause(codes, 0x7777), Cause::kDeviceError) << "unknown codes refuse";
}

TEST(DeviceCode, SaysWhetherTheDeviceMayHaveWritten) {
  static constexpr DeviceCode kCodes[] = {
      {.code = 0x02, .text = "illegal data address"},
      {.code = 0x10, .text = "no response behind the gateway", .may_have_written = true}};
  EXPECT_TRUE(may_have_written(kCodes, 0x10));
  EXPECT_FALSE(may_have_written(kCodes, 0x02));
  EXPECT_FALSE(may_have_written(kCodes, 0x5A)) << "unknown codes refuse";
  EXPECT_TRUE(may_have_written(kCodes, 0)) << "a failure without a code";
}

// Codes of each family that are temporary states. All others are refusals or line errors.
TEST(DeviceCode, StatesOfTheMomentByFamily) {
  using Codes = std::set<std::uint16_t>;
  const Codes kFins{1,      2,      0x0B,   0x21,   0x0100, 0x0200, 0x0204, 0x0205, 0x0300,
                    0x2200, 0x2201, 0x2203, 0x2206, 0x2502, 0x3001, 0x4001, 0x7020, 0x7025};
  const Codes kMc{0x4010, 0x4013, 0xC035, 0xCEE0, 0xCF70, 0xCF71};
  const Codes kMcSerial{0x4010, 0x4013, 0x7E47, 0x7F01, 0x7F31};
  const Codes kDf1{1,    2,    4,    5,    7,      8,      0x20,   0x30,   0x40,
                   0x70, 0x90, 0xB0, 0xC0, 0xF008, 0xF00C, 0xF01A, 0xF01B, 0xF01F};
  const std::map<std::string_view, Codes> expected{{"allen-bradley-df1", kDf1},
                                                   {"modbus-rtu", {4, 5, 6, 8, 0x0A, 0x0B}},
                                                   {"modbus-ascii", {4, 5, 6, 8, 0x0A, 0x0B}},
                                                   {"modbus-tcp", {4, 5, 6, 8, 0x0A, 0x0B}},
                                                   {"s7-ppi", {1, 2, 9, 0x8001, 0x8404}},
                                                   {"s7-tcp", {1, 2, 9, 0x8001, 0x8404}},
                                                   {"omron-hostlink", {1, 2, 0x0B, 0x21}},
                                                   {"omron-fins", kFins},
                                                   {"s7-freeport", {}},
                                                   {"mitsubishi-fx", {}},
                                                   {"mitsubishi-mc", kMc},
                                                   {"mitsubishi-mc-serial", kMcSerial},
                                                   {"dtc", {}}};
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1});
    ASSERT_TRUE(made.has_value()) << entry.name;
    Codes found;
    for (const DeviceCode& row : (*made)->traits().codes) {
      if (row.cause == Cause::kDeviceBusy) found.insert(row.code);
    }
    ASSERT_TRUE(expected.contains(entry.name)) << entry.name;
    EXPECT_EQ(found, expected.at(entry.name)) << entry.name;
  }
}

TEST(Registry, AnUnknownOptionIsAFaultOfThatOption) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 1, .options = {{"no-such-option", "1"}}});
    ASSERT_FALSE(made.has_value()) << entry.name;
    EXPECT_EQ(made.error().option, "no-such-option");
  }
}

struct WrongOption {
  std::string_view protocol;
  DeviceLink link;
  std::string_view what, allowed;
};

const WrongOption kWrongOptions[] = {
    {"s7-ppi",
     {.address = 2, .options = {{"master", "2"}}},
     "the master's address is the station's own",
     "0..126 without the stations of the bus"},
    {"s7-ppi",
     {.address = 2, .options = {{"poll-delay-ms", "5x"}}},
     "'5x' is no such number",
     "0..1000"},
    {"s7-tcp",
     {.options = {{"tsap", "10.0x"}}},
     "tsap '10.0x' is no TSAP",
     "two hexadecimal numbers of two digits: \"10.01\""},
    {"s7-tcp",
     {.options = {{"local-tsap", "10-01"}}},
     "local-tsap '10-01' is no TSAP",
     "two hexadecimal numbers of two digits: \"10.01\""},
    {"modbus-rtu",
     {.long_address = "123456789012"},
     "address 123456789012 is outside what modbus-rtu has",
     "1..247"},
    {"modbus-rtu",
     {.options = {{"mask-writ", "true"}}},
     "option 'mask-writ' is unknown to modbus-rtu; did you mean 'mask-write'?",
     "write-single, mask-write, read-write"}};

TEST(Registry, AWrongOptionIsNamedWithWhatIsAllowed) {
  for (const WrongOption& row : kWrongOptions) {
    const auto made = find_protocol(row.protocol)->make(row.link);
    ASSERT_FALSE(made.has_value()) << row.what;
    EXPECT_EQ(made.error().what, row.what);
    EXPECT_EQ(made.error().allowed, row.allowed);
  }
  const auto ppi = find_protocol("s7-ppi");
  EXPECT_TRUE(ppi->make({.address = 2, .options = {{"master", "3"}}}).has_value());
}

TEST(Registry, AnAddressOutsideTheFamilyIsAFault) {
  for (const ProtocolEntry& entry : protocols()) {
    const auto made = entry.make({.address = 40000});
    ASSERT_FALSE(made.has_value()) << entry.name;
    EXPECT_EQ(made.error().option, "");
    EXPECT_FALSE(made.error().allowed.empty());
  }
}

}  // namespace
}  // namespace fieldcast::test
