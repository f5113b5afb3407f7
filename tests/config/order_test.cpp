// The order in which each family keeps wide values and texts, and channels that lie on each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/model/overlap.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

BridgeSpec loaded(const std::string& protocol, const std::string& channels,
                  const std::string& defaults = "{}") {
  const std::string text = "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n" +
                           ("    protocol: " + protocol + "\n    defaults: " + defaults) +
                           "\n    devices:\n      - name: d\n        address: 1\n" +
                           "        channels:\n" + channels;
  auto spec = load_text(text, "plant.yaml", {});
  if (!spec) throw std::runtime_error(to_text(spec.error()));
  return *std::move(spec);
}

Encoding encoding_of(const std::string& protocol, const std::string& at, const std::string& type,
                     const std::string& more = {}) {
  return loaded(protocol,
                "          - { name: c, at: \"" + at + "\", type: " + type + more + " }\n")
      .buses[0]
      .devices[0]
      .channels[0]
      .encoding;
}

constexpr auto kLowWord = WordOrder::kLittleEndian, kHighWord = WordOrder::kBigEndian;
constexpr auto kLowByte = ByteOrder::kLittleEndian, kHighByte = ByteOrder::kBigEndian;

TEST(Order, OfTheFamilyIsTheDefault) {
  EXPECT_EQ(encoding_of("mitsubishi-fx", "D0", "int32").word_order, kLowWord);
  EXPECT_EQ(encoding_of("mitsubishi-fx", "D0", "int32").byte_order, kHighByte);
  EXPECT_EQ(encoding_of("mitsubishi-fx", "D0", "string(8)").byte_order, kLowByte);
  EXPECT_EQ(encoding_of("mitsubishi-fx", "C200", "int32").word_order, kHighWord)
      << "one item, which the device orders itself";
  EXPECT_EQ(encoding_of("omron-hostlink", "DM100", "float32").word_order, kLowWord);
  EXPECT_EQ(encoding_of("omron-hostlink", "DM100", "string(8)").byte_order, kHighByte);
  EXPECT_EQ(encoding_of("s7-ppi", "VD100", "uint32").word_order, kHighWord);
  EXPECT_EQ(encoding_of("s7-ppi", "VB100", "string(8)").byte_order, kHighByte);
  EXPECT_EQ(encoding_of("modbus-rtu", "holding:1", "uint32").word_order, kHighWord);
  EXPECT_EQ(encoding_of("modbus-rtu", "holding:1", "string(8)").byte_order, kHighByte);
}

TEST(Order, OfTheFileOverridesTheFamilys) {
  EXPECT_EQ(encoding_of("mitsubishi-fx", "D0", "int32", ", word-order: big-endian").word_order,
            kHighWord);
  EXPECT_EQ(encoding_of("mitsubishi-fx", "D0", "string(8)", ", byte-order: big-endian").byte_order,
            kHighByte);
  const auto spec = loaded("omron-hostlink", "          - { name: c, at: DM100, type: int32 }\n",
                           "{ word-order: big-endian }");
  EXPECT_EQ(spec.buses[0].devices[0].channels[0].encoding.word_order, kHighWord);
}

// S7 keeps the low byte of a word at the higher address, so its bits 0 to 7 are there.
TEST(Order, ABitOfAWideAddressIsInTheItemThatHoldsIt) {
  const auto place = [](const std::string& at, int bit) {
    const auto spec = loaded("s7-ppi", "          - { name: c, at: " + at +
                                           ", type: bool, bit: " + std::to_string(bit) + " }\n");
    const ChannelSpec& channel = spec.buses[0].devices[0].channels[0];
    return std::tuple(channel.range.first, channel.range.count, *channel.encoding.bit);
  };
  EXPECT_EQ(place("VW10", 3), std::tuple(11u, 1u, 3));
  EXPECT_EQ(place("VW10", 9), std::tuple(10u, 1u, 1));
  EXPECT_EQ(place("VD10", 0), std::tuple(13u, 1u, 0));
  EXPECT_EQ(place("VD10", 31), std::tuple(10u, 1u, 7));
  EXPECT_EQ(place("VB10", 3), std::tuple(10u, 1u, 3));
  const auto fault = [](const std::string& channel) {
    return faults_of(load_text(
        "bridge: b\nbuses:\n  - { name: bus, port: { serial: /dev/ttyS0 }, protocol: s7-ppi, "
        "devices: [ { name: d, address: 2, channels: [ { name: c, type: bool, " +
            channel + " } ] } ] }\n",
        "plant.yaml", {}));
  };
  EXPECT_THAT(fault("at: VW10, bit: 16"),
              testing::HasSubstr("bit 16 is beyond 'VW10'; allowed: 0 to 15"));
  EXPECT_THAT(fault("at: VW10"),
              testing::EndsWith("a bool in 'VW10' needs a bit; allowed: a bit in 'at', or 'bit': "
                                "0 to 15\n"));
}

std::vector<std::string> warnings(const std::string& channels) {
  std::vector<std::string> texts;
  const BridgeSpec spec = loaded("modbus-rtu", channels);
  for (const Overlap& overlap : overlaps_of(spec.buses[0])) texts.push_back(to_text(overlap));
  return texts;
}

TEST(Overlap, WideValuesOneRegisterApartAreReported) {
  EXPECT_EQ(warnings("          - { name: b, at: \"holding:101\", type: float32 }\n"
                     "          - { name: a, at: \"holding:100\", type: float32 }\n"
                     "          - { name: c, at: \"holding:104\", type: float32 }\n"),
            (std::vector<std::string>{
                "d/a (holding:100, float32) and d/b (holding:101, float32) overlap in another "
                "type: is one of the addresses off by one?"}));
}

TEST(Overlap, AnotherTypeAtOnePlaceIsReported) {
  EXPECT_EQ(warnings("          - { name: a, at: \"holding:100\", type: int16 }\n"
                     "          - { name: b, at: \"holding:100\", type: uint16 }\n")
                .size(),
            1u);
  // A text over many channels: each channel behind it is reported once.
  EXPECT_EQ(warnings("          - { name: a, at: \"holding:100\", type: string(20) }\n"
                     "          - { name: b, at: \"holding:102\", type: uint16 }\n"
                     "          - { name: c, at: \"holding:105\", type: uint16 }\n")
                .size(),
            2u);
}

TEST(Overlap, PartsOfAWordOtherNamesAndNeighboursAreNone) {
  EXPECT_TRUE(
      warnings("          - { name: a, at: \"holding:100\", type: uint16 }\n"
               "          - { name: again, at: \"holding:100\", type: uint16, scale: 0.1 }\n"
               "          - { name: bit, at: \"holding:100.3\" }\n"
               "          - { name: byte, at: \"holding:100\", type: uint8, byte: low }\n"
               "          - { name: next, at: \"holding:101\", type: float32 }\n"
               "          - { name: other, at: \"input-register:100\", type: int32 }\n")
          .empty());
}

TEST(Overlap, ChannelsShareTheRegisterOfTheirExponent) {
  EXPECT_TRUE(
      warnings("          - { name: a, at: \"holding:100\", type: uint16, exponent-from: 40104 }\n"
               "          - { name: b, at: \"holding:101\", type: uint16, exponent-from: 40104 }\n"
               "          - { name: c, at: \"holding:104\", type: uint32, exponent-from: 40104 }\n"
               "          - { name: exponent, at: \"holding:103\", type: int16 }\n")
          .empty());
  EXPECT_EQ(
      warnings("          - { name: a, at: \"holding:100\", type: uint32, exponent-from: 40104 }\n"
               "          - { name: b, at: \"holding:101\", type: uint16, exponent-from: 40104 }\n")
          .size(),
      1u);
}

// "unit" of the instrument is one byte without a sign, "analog" has four.
std::string faults_of_instrument(const std::string& channel) {
  const std::string text =
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n"
      "    protocol: instrument\n    devices:\n      - name: d\n"
      "        address: 1\n        channels: [ " +
      channel + " ]\n";
  const auto spec = load_text(text, "plant.yaml", disk_reader(), default_options());
  return spec ? "" : to_text(spec.error());
}

TEST(Bytes, OfDeclaredFieldsTakeATypeOfOneByteWithTheirSign) {
  EXPECT_EQ(faults_of_instrument("{ name: c, at: unit, type: uint8 }"), "");
  EXPECT_EQ(faults_of_instrument("{ name: c, at: unit, type: bcd8 }"), "");
  EXPECT_EQ(faults_of_instrument("{ name: c, at: output, type: uint8, access: read-write }"), "");
  EXPECT_NE(faults_of_instrument("{ name: c, at: unit, type: int8 }")
                .find("'unit' is declared without a sign, type int8 has one"),
            std::string::npos);
  EXPECT_NE(faults_of_instrument("{ name: c, at: analog, type: uint8 }")
                .find("type uint8 has 8 bits, 'analog' has 32"),
            std::string::npos);
}

TEST(Bytes, OfAWordAreReadInTheirPlace) {
  EXPECT_EQ(encoding_of("modbus-rtu", "holding:1", "uint8", ", byte: low").bit, 0);
  EXPECT_EQ(encoding_of("modbus-rtu", "holding:1", "int8", ", byte: high").bit, 8);
  EXPECT_EQ(encoding_of("dtc", "int32:1", "bcd8", ", byte: 3").bit, 24);
  EXPECT_EQ(encoding_of("s7-ppi", "VB10", "uint8").bit, std::nullopt);
  EXPECT_EQ(encoding_of("s7-freeport", "window:3", "int8").bit, std::nullopt);
}

}  // namespace
}  // namespace fieldcast::config
