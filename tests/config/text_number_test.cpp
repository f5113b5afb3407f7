#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

constexpr auto kGauge = R"(
summary: a gauge that speaks in text
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ constant: "R" }, { is: address }]
    answer: [{ constant: "A" }, { name: level, is: value, text: 7 },
             { name: target, is: value, text: "+000.00" }, { name: unit, is: value, text: 3 },
             { name: code, is: value, text: hex(4) }]
)";

Loaded gauge(const std::string& channel) {
  return load_text(
      "bridge: b\nbuses:\n  - { name: bus, port: { serial: /dev/ttyS0 }, protocol: gauge, devices: "
      "[ { name: d, address: 1, channels: [\n{ name: c, " +
          channel + " } ] } ] }\n",
      "plant.yaml", texts({{"protocols/gauge.yaml", kGauge}}));
}
std::string gauge_faults(const std::string& channel) { return faults_of(gauge(channel)); }
Encoding encoding_of(const Loaded& loaded) {
  EXPECT_EQ(faults_of(loaded), "");
  return loaded ? loaded->buses[0].devices[0].channels[0].encoding : Encoding{};
}

TEST(NumberOnText, IsSaidByTheChannelOrByTheDeclaration) {
  const Encoding said = encoding_of(gauge("at: level, type: float32, text: decimal"));
  EXPECT_EQ(said.text_number, (TextNumber{.kind = TextNumber::Kind::kDecimal}));
  EXPECT_EQ(said.string_bytes, 7);
  const Encoding known = encoding_of(gauge("at: target, type: float64"));
  EXPECT_EQ(
      known.text_number,
      (TextNumber{
          .kind = TextNumber::Kind::kDecimal, .decimals = 2, .leading_zeros = true, .plus = true}));
  EXPECT_EQ(known.string_bytes, 7);
  EXPECT_EQ(encoding_of(gauge("at: target, type: float64, text: decimal-comma")).text_number.kind,
            TextNumber::Kind::kDecimalComma);
  EXPECT_FALSE(encoding_of(gauge("at: target, type: string(7)")).text_number);
  EXPECT_FALSE(encoding_of(gauge("at: unit, type: string(2)")).text_number);
}

TEST(NumberOnText, ADeclaredTextCanBeTooShortForAFloatInHexadecimal) {
  EXPECT_EQ(gauge_faults("at: level, type: float32, text: hex"),
            "plant.yaml:4:44: hex(7) does not spell a float32; allowed: hex(8) to hex(18)\n");
  EXPECT_EQ(gauge_faults("at: level, type: uint32, text: hex"), "");
  EXPECT_EQ(gauge_faults("at: code, type: float32"),
            "plant.yaml:4:28: hex(4) does not spell a float32; allowed: an integer type\n");
  EXPECT_EQ(gauge_faults("at: code, type: uint16"), "");
}

TEST(NumberOnText, AnyOtherTypeOnATextIsAFault) {
  EXPECT_EQ(gauge_faults("at: level, type: float32"),
            "plant.yaml:4:29: type float32 at 'level', which is a text of 7 characters; allowed: "
            "string(7), or text: decimal, decimal-comma, hex or a picture, where it spells a "
            "number\n");
  EXPECT_EQ(gauge_faults("at: level, type: bool"),
            "plant.yaml:4:29: type bool at 'level', which is a text of 7 characters; allowed: "
            "string(7)\n");
  EXPECT_EQ(gauge_faults("at: target, type: bcd32"),
            "plant.yaml:4:30: type bcd32 at 'target', which is a text of 7 characters; allowed: "
            "string(7)\n");
  EXPECT_EQ(gauge_faults("at: level, type: string(20)"),
            "plant.yaml:4:29: string(20) at 'level', which is a text of 7 characters; allowed: "
            "string(7); did you mean string(7)?\n");
  EXPECT_EQ(gauge_faults("at: level, type: float32, text: decimal(5)"),
            "plant.yaml:4:44: a number of 5 characters at 'level', which is a text of 7 "
            "characters; allowed: 7 characters\n");
}

TEST(DateAndTime, IsTheTypeOfItsAddress) {
  const auto cpu = [](const std::string& channel) {
    return load_text(
        "bridge: b\nbuses:\n  - { name: bus, port: { tcp: \"127.0.0.1:102\" }, protocol: s7-tcp, "
        "devices: [ { name: d, address: 1, channels: [\n{ name: c, " +
            channel + " } ] } ] }\n",
        "plant.yaml", texts({}));
  };
  for (const std::string type : {"", ", type: string(29)"}) {
    const Loaded loaded = cpu("at: DB1.DTL4, access: read-write" + type);
    EXPECT_EQ(
        encoding_of(loaded),
        (Encoding{.type = ValueType::kString, .string_bytes = 29, .layout = TextLayout::kDtl}));
    EXPECT_EQ(loaded->buses[0].devices[0].channels[0].range.count, 12u);
  }
  EXPECT_EQ(encoding_of(cpu("at: DB1.DT4")).layout, TextLayout::kDateAndTime);
  for (const std::string type : {"string(28)", "string(30)", "uint64", "float64, text: decimal"})
    EXPECT_THAT(faults_of(cpu("at: DB1.DTL4, type: " + type)),
                testing::HasSubstr("at 'DB1.DTL4', which is a date; allowed: string(29)"));
}

TEST(NumberOnText, IsInTheRegistersOfAnyProtocol) {
  const auto loaded = load_text(
      plant("          - { name: a, at: \"holding:10\", type: float64, text: \"+000.00\", "
            "access: read-write }\n"
            "          - { name: b, at: \"holding:20\", type: uint16, text: hex(4) }\n"),
      "plant.yaml", {});
  ASSERT_EQ(faults_of(loaded), "");
  const auto& channels = loaded->buses[0].devices[0].channels;
  EXPECT_EQ(channels[0].range.count, 4u);
  EXPECT_EQ(channels[1].range.count, 2u);
}

}  // namespace
}  // namespace fieldcast::config
