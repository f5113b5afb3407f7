#include <gtest/gtest.h>

#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

Encoding typed(ValueType type) { return {.type = type}; }
Value whole(std::uint64_t value) { return value; }
Value integer(std::int64_t value) { return value; }

TEST(NotAvailable, IsTypedAsBitsOrAsANumberOfTheType) {
  EXPECT_EQ(parse_not_available(typed(ValueType::kInt16), "0x8000"), 0x8000u);
  EXPECT_EQ(parse_not_available(typed(ValueType::kInt16), "-32768"), 0x8000u);
  EXPECT_EQ(parse_not_available({.type = ValueType::kInt16, .scale = 0.1}, "32767"), 0x7FFFu);
  EXPECT_EQ(parse_not_available(typed(ValueType::kUint64), "0xFFFFFFFFFFFFFFFF"), UINT64_MAX);
  EXPECT_EQ(parse_not_available(typed(ValueType::kFloat32), "0xFF7FFFFF"), 0xFF7FFFFFu);
  EXPECT_EQ(parse_not_available(typed(ValueType::kFloat32), "-1"), 0xBF800000u);
  EXPECT_EQ(parse_not_available(typed(ValueType::kInt16), "32768").error(), Cause::kRange);
  EXPECT_EQ(parse_not_available(typed(ValueType::kInt16), "0x10000").error(), Cause::kRange);
  EXPECT_EQ(parse_not_available(typed(ValueType::kBcd16), "12345").error(), Cause::kRange);
  for (const char* nan : {"nan", "NaN", ".nan", ".NaN"}) {
    EXPECT_EQ(parse_not_available(typed(ValueType::kFloat32), nan), 0x7FC00000u) << nan;
    EXPECT_EQ(parse_not_available(typed(ValueType::kFloat64), nan), 0x7FF8000000000000u) << nan;
    EXPECT_EQ(parse_not_available(typed(ValueType::kUint16), nan).error(), Cause::kWrongType)
        << nan;
  }
  EXPECT_EQ(parse_not_available(typed(ValueType::kUint16), "").error(), Cause::kWrongType);
  EXPECT_EQ(parse_not_available(typed(ValueType::kUint16), "0X10"), 0x10u);
  EXPECT_EQ(parse_not_available(typed(ValueType::kUint16), "0xG").error(), Cause::kWrongType);
}

TEST(ValueText, NamesOfTypesLeadBack) {
  for (int type = 0; type <= static_cast<int>(ValueType::kBcd8); ++type) {
    EXPECT_EQ(value_type_from(to_text(static_cast<ValueType>(type))), static_cast<ValueType>(type));
  }
  EXPECT_EQ(value_type_from("int24"), std::nullopt);
}

TEST(ValueText, TypedTextsBecomeValuesOfTheChannelsKind) {
  EXPECT_EQ(parse_value(typed(ValueType::kBool), " On "), Value{true});
  EXPECT_EQ(parse_value(typed(ValueType::kBool), "0"), Value{false});
  EXPECT_EQ(parse_value(typed(ValueType::kInt16), "-12"), integer(-12));
  EXPECT_EQ(parse_value(typed(ValueType::kUint16), "0x1F"), whole(31));
  EXPECT_EQ(parse_value(typed(ValueType::kUint16), "0X1F"), whole(31));
  EXPECT_EQ(parse_value(typed(ValueType::kFloat64), "9223372036854775808"),
            Value{9223372036854775808.0});
  EXPECT_EQ(parse_value(typed(ValueType::kUint16), "2.0"), whole(2));
  EXPECT_EQ(parse_value(typed(ValueType::kUint64), "18446744073709551615"), whole(UINT64_MAX));
  EXPECT_EQ(parse_value(typed(ValueType::kInt64), "-9223372036854775808"), integer(INT64_MIN));
  EXPECT_EQ(parse_value(typed(ValueType::kUint64), "1e19"), whole(10'000'000'000'000'000'000u));
  for (const char* text : {"2e19", "-2e19"})
    EXPECT_EQ(parse_value(typed(ValueType::kUint64), text), tl::unexpected(Cause::kRange)) << text;
  EXPECT_EQ(parse_value(typed(ValueType::kFloat32), "7"), Value{7.0});
  EXPECT_EQ(parse_value({.type = ValueType::kInt16, .scale = 0.1}, "+2.5"), Value{2.5});
  EXPECT_EQ(parse_value({.type = ValueType::kString, .string_bytes = 9}, " x "),
            Value{std::string(" x ")});
}

TEST(ValueText, WhatIsNotOfTheKindIsRefused) {
  const auto wrong = tl::unexpected(Cause::kWrongType);
  const auto range = tl::unexpected(Cause::kRange);
  for (const auto* text :
       {"", "-", "+-1", "1 2", "0x", "0xG", "1e", "abc", "2.5", "--3", "-+1", "+"}) {
    EXPECT_EQ(parse_value(typed(ValueType::kInt16), text), wrong) << text;
  }
  EXPECT_EQ(parse_value(typed(ValueType::kBool), "2"), wrong);
  EXPECT_EQ(parse_value(typed(ValueType::kUint16), "-1"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kFloat32), "nan"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kFloat32), "inf"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kFloat64), "1e999"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kInt64), "9223372036854775808"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kUint64), "18446744073709551616"), range);
  EXPECT_EQ(parse_value(typed(ValueType::kInt64), "-9223372036854775809"), range);
}

TEST(ValueText, WordsOfABoolHaveNoCase) {
  const Encoding encoding{.type = ValueType::kBool};
  for (const char* text : {"FALSE", "Off", "NO", "0"})
    EXPECT_EQ(parse_value(encoding, text), Value{false}) << text;
  for (const char* text : {"TRUE", "On", "YES", "1"})
    EXPECT_EQ(parse_value(encoding, text), Value{true}) << text;
}

TEST(EncodingText, IsReadAgain) {
  for (const char* text : {"bool", "uint16", "float64", "string(1)", "string(16)"}) {
    const auto encoding = encoding_from(text);
    ASSERT_TRUE(encoding) << text;
    EXPECT_EQ(to_text(*encoding), text);
  }
  for (const char* text : {"", "uint17", "uint16(2)", "string", "string(", "string()", "string(0)",
                           "string(16", "string(16))", "string(16]", "string(99999)"})
    EXPECT_FALSE(encoding_from(text)) << text;
  EXPECT_EQ(encoding_from("string(" + std::to_string(kMaxStringBytes) + ")")->string_bytes,
            kMaxStringBytes);
  EXPECT_FALSE(encoding_from("string(" + std::to_string(kMaxStringBytes + 1) + ")"));
}

TEST(Part, IsAByteOfAWiderItem) {
  EXPECT_TRUE(is_part({.type = ValueType::kUint8, .bit = 8}, 16));
  EXPECT_TRUE(is_part({.type = ValueType::kBool, .bit = 3}, 16));
  EXPECT_FALSE(is_part({.type = ValueType::kUint8, .bit = 0}, 8)) << "the whole item";
  EXPECT_FALSE(is_part({.type = ValueType::kUint16, .bit = 0}, 32)) << "wider than a byte";
  EXPECT_FALSE(is_part({.type = ValueType::kUint8}, 16)) << "no place in the item";
}

}  // namespace
}  // namespace fieldcast
