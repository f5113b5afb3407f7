#include "core/model/fit.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using About = FitFault::About;

const Area kBits{.name = "coil", .item_bits = 1};
const Area kBytes{.name = "V", .item_bits = 8};
const Area kWords{.name = "holding", .item_bits = 16};
const Area kDoubles{.name = "D", .item_bits = 32};

// What is wrong, empty if it fits.
std::string fault(const ParsedAddress& address, const Area& area, const Encoding& encoding) {
  const auto found = check_fit("x", address, area, encoding);
  return found ? found->what : "";
}

Encoding of(ValueType type, std::optional<std::uint8_t> bit = std::nullopt) {
  Encoding encoding;
  encoding.type = type;
  encoding.bit = bit;
  return encoding;
}

TEST(Fit, ABoolNeedsABitOfItsItem) {
  EXPECT_EQ(fault({}, kBits, of(ValueType::kBool)), "");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kBool, 15)), "");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kBool, 16)), "bit 16 is beyond 'x'");
  const auto without = check_fit("DM1", {}, kWords, of(ValueType::kBool));
  ASSERT_TRUE(without);
  EXPECT_EQ(without->what, "a bool in 'DM1' needs a bit");
  EXPECT_EQ(without->allowed, "a bit in 'at', or 'bit': 0 to 15");
  EXPECT_EQ(without->suggestion, "DM1.0");
  EXPECT_EQ(without->about, About::kType);
  const auto beyond = check_fit("x", {}, kWords, of(ValueType::kBool, 16));
  EXPECT_EQ(beyond->allowed, "0 to 15");
  EXPECT_EQ(beyond->about, About::kPart);
  EXPECT_EQ(fault({}, kBits, of(ValueType::kBool, 0)), "a bit of 'x', which is a bit already");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kInt16, 3)), "type int16 with a bit of a word");
  EXPECT_EQ(fault({.bit = 3}, kWords, of(ValueType::kInt8, 8)), "type int8 with a bit of a word");
}

TEST(Fit, ABitHasNoWiderType) {
  EXPECT_EQ(fault({}, kBits, of(ValueType::kUint16)),
            "type uint16 does not fit 'x', which is one bit");
  EXPECT_EQ(fault({.width_bits = 1}, kWords, of(ValueType::kInt8)),
            "type int8 does not fit 'x', which is one bit");
}

TEST(Fit, AByteOfAnItemStartsAtAMultipleOfEight) {
  EXPECT_EQ(fault({}, kWords, of(ValueType::kUint8, 0)), "");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kUint8, 8)), "");
  EXPECT_EQ(fault({}, kDoubles, of(ValueType::kUint8, 24)), "");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kUint8, 4)), "that byte is beyond 'x'");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kUint8, 16)), "that byte is beyond 'x'");
  EXPECT_EQ(fault({}, kBytes, of(ValueType::kUint8, 0)), "a byte of 'x', which is a byte already");
  EXPECT_EQ(fault({.width_bits = 32}, kWords, of(ValueType::kUint8, 0)),
            "a byte of 'x', which has 32 bits");
  EXPECT_EQ(fault({.width_bits = 16}, kWords, of(ValueType::kUint8, 0)), "");
}

TEST(Fit, AByteAloneNeedsAnItemOfEightBits) {
  EXPECT_EQ(fault({}, kBytes, of(ValueType::kInt8)), "");
  EXPECT_EQ(fault({.width_bits = 8}, kBytes, of(ValueType::kInt8)), "");
  EXPECT_EQ(fault({.width_bits = 16}, kBytes, of(ValueType::kInt8)),
            "type int8 has 8 bits, 'x' has 16");
  const auto word = check_fit("x", {}, kWords, of(ValueType::kInt8));
  ASSERT_TRUE(word);
  EXPECT_EQ(word->what, "type int8 has 8 bits, 'x' has 16");
  EXPECT_EQ(word->allowed, "a type of 16 bits, or byte: low, byte: high");
  const auto wide = check_fit("x", {.width_bits = 32}, kWords, of(ValueType::kInt8));
  EXPECT_EQ(wide->allowed, "a type of 32 bits");
}

TEST(Fit, ADeclaredFieldOfAByteHasItsSign) {
  EXPECT_EQ(fault({.value_bits = 8, .value_signed = true}, kWords, of(ValueType::kInt8)), "");
  EXPECT_EQ(fault({.value_bits = 8}, kWords, of(ValueType::kUint8)), "");
  const auto without = check_fit("x", {.value_bits = 8}, kWords, of(ValueType::kInt8));
  ASSERT_TRUE(without);
  EXPECT_EQ(without->what, "'x' is declared without a sign, type int8 has one");
  EXPECT_EQ(without->suggestion, "uint8");
  const auto with =
      check_fit("x", {.value_bits = 8, .value_signed = true}, kWords, of(ValueType::kUint8));
  ASSERT_TRUE(with);
  EXPECT_EQ(with->what, "'x' is declared with a sign, type uint8 has none");
  EXPECT_EQ(with->suggestion, "int8");
  EXPECT_EQ(fault({.value_bits = 9}, kWords, of(ValueType::kUint8)),
            "type uint8 has 8 bits, 'x' has 16");
}

TEST(Fit, TheNotationFixesTheWidth) {
  EXPECT_EQ(fault({.width_bits = 32}, kWords, of(ValueType::kFloat32)), "");
  EXPECT_EQ(fault({}, kWords, of(ValueType::kFloat64)), "");
  const auto found = check_fit("VW10", {.width_bits = 16}, kBytes, of(ValueType::kInt32));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->what, "type int32 has 32 bits, 'VW10' has 16");
  EXPECT_EQ(found->allowed, "a type of 16 bits");
  const Encoding text{.type = ValueType::kString, .string_bytes = 6};
  EXPECT_EQ(fault({.width_bits = 16}, kWords, text), "");
}

TEST(Fit, ATextIsAStringThatIsNotLonger) {
  const ParsedAddress text{.text_characters = 8};
  const auto string = [](std::uint16_t bytes) {
    return Encoding{.type = ValueType::kString, .string_bytes = bytes};
  };
  EXPECT_EQ(fault(text, kBytes, string(8)), "");
  EXPECT_EQ(fault(text, kBytes, string(1)), "");
  const auto longer = check_fit("x", text, kBytes, string(9));
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->what, "string(9) at 'x', which is a text of 8 characters");
  EXPECT_EQ(longer->suggestion, "string(8)");
  const auto number = check_fit("x", text, kBytes, of(ValueType::kUint16));
  ASSERT_TRUE(number);
  EXPECT_EQ(number->what, "type uint16 at 'x', which is a text of 8 characters");
  EXPECT_NE(number->allowed.find("text: decimal"), std::string::npos);
  for (const ValueType type : {ValueType::kBool, ValueType::kBcd16})
    EXPECT_EQ(check_fit("x", text, kBytes, of(type))->allowed, "string(8)");
  const ParsedAddress counted{.text_layout = TextLayout::kCounted};
  EXPECT_EQ(fault(counted, kBytes, string(8)), "");
  EXPECT_EQ(fault(counted, kBytes, of(ValueType::kUint16)),
            "type uint16 at 'x', which is a string");
}

TEST(Fit, BytesHaveNames) {
  EXPECT_EQ(byte_names(16), "byte: low, byte: high");
  EXPECT_EQ(byte_names(32), "byte: 0 to 3");
  EXPECT_EQ(byte_names(64), "byte: 0 to 7");
  EXPECT_EQ(why_no_byte_write("VB1", Area{.byte_write = true}), std::nullopt);
  EXPECT_EQ(why_no_byte_write("D1", kWords),
            "a byte of D1 cannot be written without the rest of it");
}

std::string fixed(const ParsedAddress& address, const Area& area) {
  const auto type = fixed_type(address, area);
  return type ? to_text(*type) : "";
}

TEST(FixedType, IsThatOfABitATextOrTheFamily) {
  EXPECT_EQ(fixed({}, kBits), "bool");
  EXPECT_EQ(fixed({.bit = 0}, kWords), "bool");
  EXPECT_EQ(fixed({.width_bits = 1}, kWords), "bool");
  EXPECT_EQ(fixed({.width_bits = 2}, kWords), "");
  EXPECT_EQ(fixed({.text_characters = 8}, kBytes), "string(8)");
  EXPECT_EQ(fixed({.text_characters = 8, .text_number = {TextNumber::Kind::kDecimal}}, kBytes), "");
  EXPECT_EQ(fixed({}, Area{.type = ValueType::kBcd16}), "bcd16");
  EXPECT_EQ(fixed({}, kWords), "");
}

std::string implied(const ParsedAddress& address, const Area& area) {
  const auto type = implied_type(address, area);
  return type ? to_text(*type) : "";
}

TEST(ImpliedType, HasTheWidthAndTheSignOfTheAddress) {
  EXPECT_EQ(implied({}, kWords), "uint16");
  EXPECT_EQ(implied({.width_bits = 32}, kBytes), "uint32");
  EXPECT_EQ(implied({.value_bits = 8}, kWords), "uint8");
  EXPECT_EQ(implied({.value_bits = 9}, kWords), "uint16");
  EXPECT_EQ(implied({.value_bits = 12, .value_signed = true}, kWords), "int16");
  EXPECT_EQ(implied({.width_bits = 24}, kBytes), "");
  EXPECT_EQ(implied({.bit = 1}, kWords), "bool");
  EXPECT_EQ(implied({.text_layout = TextLayout::kCounted}, kBytes), "");
  EXPECT_EQ(implied({.text_number = {TextNumber::Kind::kHex}}, kBytes), "uint64");
  EXPECT_EQ(implied({.text_number = {TextNumber::Kind::kDecimal}}, kBytes), "float64");
}

TEST(FormOf, OfAnAddressIsTakenByNumbers) {
  const ParsedAddress text{.bit = 5,
                           .text_characters = 8,
                           .text_number = {TextNumber::Kind::kDecimal},
                           .text_layout = TextLayout::kCounted};
  const Encoding number = with_form_of(text, of(ValueType::kInt16, 2));
  EXPECT_EQ(number.bit, 5);
  EXPECT_EQ(number.text_number.kind, TextNumber::Kind::kDecimal);
  EXPECT_EQ(number.string_bytes, 8);
  EXPECT_EQ(number.layout, TextLayout::kCounted);
  for (const ValueType type : {ValueType::kBool, ValueType::kString, ValueType::kBcd16})
    EXPECT_FALSE(with_form_of(text, of(type)).text_number);
  EXPECT_EQ(with_form_of({}, of(ValueType::kInt16, 2)).bit, 2) << "the address has no bit";
}

}  // namespace
}  // namespace fieldcast
