// Tests values that other fields of their frame scale or sign.
#include "core/protocol/declared/scaled.hpp"

#include <gtest/gtest.h>

#include "tests/support/declared_device.hpp"
#include "tests/support/drive.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

// A controller whose limit has its own exponent, and whose count is text with a sign.
constexpr std::string_view kController = R"(
summary: controllers
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: ask, constant: "R" }, { is: address }]
    answer: &state
      - { name: begin, constant: "r" }
      - { is: decimals, of: level..mean, bits: 3 }
      - { is: unused, bits: 4 }
      - { is: sign, of: mean, bits: 1 }
      - { name: level, is: value, bytes: 2, signed: true }
      - { name: mean, is: value, bytes: 2 }
      - { name: limit, is: value, bytes: 2, signed: true }
      - { name: power, is: exponent, of: limit, signed: true }
      - { name: plus-minus, is: sign, of: count, on: 0x2D, off: 0x2B }
      - { name: count, is: value, text: decimal(6) }
      - { is: checksum, kind: sum, of: begin..count }
  - name: set the limit
    write: state
    request: &set
      - { name: ask, constant: "L" }
      - { is: address }
      - { name: limit, is: value, bytes: 2, signed: true }
      - { name: power, is: exponent, of: limit, signed: true }
    answer: *set
  - name: set the count
    write: state
    request:
      - { name: ask, constant: "C" }
      - { name: plus-minus, is: sign, of: count, on: 0x2D, off: 0x2B }
      - { name: count, is: value, text: decimal(6) }
    answer: [{ name: did, constant: "c" }]
)";

std::string text_of(ByteView items) {
  const std::string text(items.begin(), items.end());
  return text.substr(0, text.find('\0'));
}

class Scaled : public testing::Test {
 protected:
  static Bytes hex(std::string_view digits) { return from_hex(digits).value(); }
  static constexpr std::uint32_t kItems = declared::kScaledCharacters / 2;

  std::string read(std::string_view at, const Bytes& response) {
    const auto outcome = drive(*controller_.begin(controller_.read(at, kItems)), response);
    return outcome.done() ? text_of(outcome.reply[0].items) : to_text(outcome);
  }
  Request write(std::string_view at, const std::string& number) {
    Bytes items(number.begin(), number.end());
    items.resize(declared::kScaledCharacters);
    return controller_.write(at, to_hex(items));
  }
  // The request without its first `skip` bytes; "refused" if no operation can send it.
  std::string sent(std::string_view at, const std::string& number, std::size_t skip) {
    const Request request = write(at, number);
    if (!controller_.protocol().size(request)) return "refused";
    return to_hex(ByteView(controller_.request_bytes(request)).subspan(skip));
  }

  const Device controller_ = declared_by(kController, 5);
  const Bytes response_ = hex("72 82 FB2E 04D2 0019 FE 2D 202020313533 30");
};

TEST_F(Scaled, ReadsWhatTheOtherFieldsSay) {
  EXPECT_EQ(read("level", response_), "-12.34");
  EXPECT_EQ(read("mean", response_), "-12.34");
  EXPECT_EQ(read("limit", response_), "0.25");
  EXPECT_EQ(read("count", response_), "-153");
  const Bytes whole = hex("72 00 0000 04D2 0019 03 2B 202020313533 88");
  EXPECT_EQ(read("level", whole), "0");
  EXPECT_EQ(read("mean", whole), "1234");
  EXPECT_EQ(read("limit", whole), "25000");
  EXPECT_EQ(read("count", whole), "153");
}

TEST_F(Scaled, AChannelHasAnyNumericType) {
  const auto address = controller_.protocol().parse_address("level");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->text_characters, declared::kScaledCharacters);
  EXPECT_EQ(address->text_number, (TextNumber{.kind = TextNumber::Kind::kDecimal}));
}

TEST_F(Scaled, ATextWithoutDigitsLeavesItsPlaceEmpty) {
  EXPECT_EQ(read("count", hex("72 82 FB2E 04D2 0019 FE 2D 2D2D2D2D2D2D 45")), "");
}

TEST_F(Scaled, WritesTheLowestExponentAtWhichTheNumberFits) {
  EXPECT_EQ(sent("limit", "12.5", 2), "00 7D FF");
  EXPECT_EQ(sent("limit", "-12.50", 2), "FB 1E FE");
  EXPECT_EQ(sent("limit", "0", 2), "00 00 00");
  EXPECT_EQ(sent("limit", "250000", 2), "61 A8 01");
  EXPECT_EQ(sent("limit", "0.33333333333", 2), "0D 05 FC") << "rounded to 3333 e-4";
  EXPECT_EQ(sent("limit", "250001", 2), "refused") << "a digit before the point would be lost";
  EXPECT_EQ(sent("limit", "1e999", 2), "refused");
  EXPECT_EQ(sent("count", "-153", 1), "2D 20 20 20 31 35 33");
  EXPECT_EQ(sent("count", "153", 1), "2B 20 20 20 31 35 33");
  EXPECT_EQ(sent("count", "1234567", 1), "refused");
}

TEST_F(Scaled, AnEchoMayRoundButNotDiffer) {
  const auto set = [&](std::string_view number, std::string_view echo) {
    return drive(*controller_.begin(write("limit", std::string(number))), hex(echo)).done();
  };
  EXPECT_TRUE(set("12.5", "4C 05 007D FF"));
  EXPECT_TRUE(set("12.5", "4C 05 04E2 FE"));
  EXPECT_TRUE(set("0.33333333333", "4C 05 0D05 FC"));
  EXPECT_FALSE(set("12.5", "4C 05 007E FF"));
  EXPECT_FALSE(set("12.5", "4C 05 FF83 FF"));
}

TEST_F(Scaled, ThroughAllDisturbances) {
  expect_matrix({.begin = [&] { return controller_.begin(controller_.read("level", 13)); },
                 .answers = {response_},
                 .checked = true});
}

TEST_F(Scaled, IsExplained) {
  const auto loaded = config::load_declaration_text(kController, "test.yaml");
  const auto fields = declared::explain(*loaded->value, response_);
  for (const auto& [name, value] :
       {std::pair{"level", "-12.34"}, {"limit", "0.25"}, {"count", "-153"}}) {
    EXPECT_TRUE(std::ranges::any_of(fields, [&](const FrameField& field) {
      return field.name == name && field.value == value && field.fault.empty();
    })) << name;
  }
  for (std::size_t size = 0; size < response_.size(); ++size)
    (void)declared::explain(*loaded->value, ByteView(response_).first(size));
}

TEST(ScaledDecimal, ConvertsBetweenTextAndNumber) {
  using declared::Decimal;
  const auto again = [](std::string_view text) {
    const auto decimal = declared::decimal_from(text);
    return decimal ? to_text(*decimal) : "none";
  };
  for (const char* text : {"0", "12.50", "-0.05", "18446744073709551615", "0.0000000001"})
    EXPECT_EQ(again(text), text);
  EXPECT_EQ(again("  +7,5 "), "7.5");
  EXPECT_EQ(again("5e3"), "5000");
  EXPECT_EQ(again("-5e-128"), "-5e-128");
  EXPECT_EQ(again("-0.00"), "0.00");
  EXPECT_EQ(again("123456789012345678e12"), "123456789012345678e12");
  for (const char* text : {"", "-", ".", "1.2.3", "1e", "1x", "18446744073709551616"})
    EXPECT_EQ(again(text), "none") << text;
}

}  // namespace
}  // namespace fieldcast::test
