#include "tools/cli/model/address_notation.hpp"

#include <gtest/gtest.h>

#include <map>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::cli {
namespace {

// Returns the type under a known protocol; "?" if --type is required.
std::string type_in(const char* protocol, std::string_view at,
                    std::map<std::string, std::string> options = {}) {
  const auto made = find_protocol(protocol)->make({.options = std::move(options)});
  return type_at(at, {}, **made).value_or("?");
}

// Returns the type for a device with known channels; "?" with the reason.
std::string type_among(std::vector<KnownChannel> channels, std::string_view at) {
  const auto type = type_at(at, {}, channels);
  return type ? *type : "? " + type.error();
}

TEST(AddressNotation, BitsAreBoolWithoutAWord) {
  for (const auto* at : {"coil:16", "input:3", "00017", "holding:100.5", "I0.3", "CIO12.03", "X17"})
    EXPECT_EQ(type_among({}, at), "bool") << at;
}

TEST(AddressNotation, TheProtocolThatIsNamedSaysTheType) {
  EXPECT_EQ(type_in("dtc", "bit:7"), "bool");
  EXPECT_EQ(type_in("dtc", "int16:100"), "int16");
  EXPECT_EQ(type_in("dtc", "int32:40"), "int32");
  EXPECT_EQ(type_in("dtc", "float32:41"), "float32");
  EXPECT_EQ(type_in("dtc", "float64:40"), "float64");
  EXPECT_EQ(type_in("dtc", "int32:40.3"), "bool");
  EXPECT_EQ(type_in("mitsubishi-fx", "C200"), "int32");
  EXPECT_EQ(type_in("mitsubishi-fx", "C5"), "int16");
  EXPECT_EQ(type_in("mitsubishi-fx", "D100"), "uint16");
  EXPECT_EQ(type_in("mitsubishi-fx", "M14"), "bool");
  EXPECT_EQ(type_in("omron-hostlink", "T5"), "bcd16");
  EXPECT_EQ(type_in("omron-hostlink", "C5"), "bcd16");
  EXPECT_EQ(type_in("omron-hostlink", "T5", {{"mode", "fins"}}), "uint16");
  EXPECT_EQ(type_in("omron-hostlink", "DM100"), "uint16");
  EXPECT_EQ(type_in("s7-ppi", "VB100"), "uint8");
  EXPECT_EQ(type_in("s7-ppi", "VW100"), "uint16");
  EXPECT_EQ(type_in("s7-ppi", "VD204"), "uint32");
  EXPECT_EQ(type_in("s7-ppi", "AIW4"), "int16");
  EXPECT_EQ(type_in("s7-ppi", "T37"), "int32");
  EXPECT_EQ(type_in("s7-freeport", "window:3"), "uint8");
  EXPECT_EQ(type_in("modbus-rtu", "40101"), "uint16");
}

TEST(AddressNotation, ATypeThatIsSaidHolds) {
  EXPECT_EQ(type_at("float32:41", "uint32", **find_protocol("dtc")->make({})), "uint32");
  EXPECT_EQ(type_at("C5", "uint16", std::span<const KnownChannel>{}), "uint16");
}

TEST(AddressNotation, OfAnUnknownProtocolWhereAllFamiliesAgree) {
  EXPECT_EQ(type_among({}, "float32:60"), "float32");
  EXPECT_EQ(type_among({}, "VD204"), "uint32");
  EXPECT_EQ(type_among({}, "D100"), "uint16") << "of FX and of Omron";
  EXPECT_EQ(type_among({}, "pressure"), "uint16") << "of a declared protocol";
}

TEST(AddressNotation, ChannelsStateTheProtocolWhereFamiliesDisagree) {
  EXPECT_EQ(type_among({}, "C200"),
            "? C200: the type depends on the protocol: bcd16 (omron-hostlink), int16 (s7-ppi), "
            "int32 (mitsubishi-fx), uint16 (omron-fins); say --type");
  EXPECT_EQ(type_among({{"D5", "int32"}, {"Y17", "bool"}}, "C200"), "int32");
  EXPECT_EQ(type_among({{"VW100", "int16"}}, "C200"), "int16");
  EXPECT_EQ(type_among({{"W5", "uint16"}}, "T5"), "uint16") << "FINS alone has W and T";
  EXPECT_EQ(type_among({{"LR7", "uint16"}}, "T5"), "bcd16") << "C-mode alone has LR";
}

TEST(AddressNotation, CodesHaveTheWordsOfTheFamilyThatWritesSo) {
  EXPECT_EQ(device_code_at("holding:100", 2), "02 illegal data address");
  EXPECT_EQ(device_code_at("VW100", 5), "05 address out of range");
  EXPECT_EQ(device_code_at("DM100", 0x14), "14 format error");
  EXPECT_EQ(device_code_at("DM100", 0x1103), "1103 start address out of range");
  EXPECT_EQ(device_code_at("nowhere", 2), "code 02");
}

}  // namespace
}  // namespace fieldcast::cli
