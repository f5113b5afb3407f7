#include "core/codec/value_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

namespace fieldcast {
namespace {

Encoding of(ValueType type) { return {.type = type}; }
Bytes hex(std::string_view text) { return *from_hex(text); }
Value i(std::int64_t value) { return value; }
Value u(std::uint64_t value) { return value; }

struct Pair {
  Encoding encoding;
  unsigned item_bits;
  std::string items;
  Value value;
  friend void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.items; }
};

class BothWays : public testing::TestWithParam<Pair> {};

TEST_P(BothWays, DecodesAndEncodes) {
  const Pair& pair = GetParam();
  const auto decoded = decode_value(pair.encoding, pair.item_bits, hex(pair.items));
  ASSERT_TRUE(decoded.has_value()) << to_text(decoded.error());
  EXPECT_EQ(*decoded, pair.value) << to_text(*decoded);
  const auto encoded = encode_value(pair.encoding, pair.item_bits, pair.value);
  ASSERT_TRUE(encoded.has_value()) << to_text(encoded.error());
  EXPECT_EQ(to_hex(*encoded), to_hex(hex(pair.items)));
}

Encoding ordered(ValueType type, WordOrder words, ByteOrder bytes) {
  return {.type = type, .word_order = words, .byte_order = bytes};
}
constexpr auto kBig = WordOrder::kBigEndian;
constexpr auto kLow = WordOrder::kLittleEndian;
constexpr auto kSwapped = ByteOrder::kLittleEndian;

INSTANTIATE_TEST_SUITE_P(
    Registers, BothWays,
    testing::Values(
        Pair{of(ValueType::kInt8), 8, "80", i(-128)}, Pair{of(ValueType::kInt8), 8, "7F", i(127)},
        Pair{of(ValueType::kUint8), 8, "FF", u(255)}, Pair{of(ValueType::kBcd8), 8, "42", u(42)},
        Pair{ordered(ValueType::kUint8, kLow, kSwapped), 8, "12", u(0x12)},
        Pair{of(ValueType::kInt8), 16, "FFFE", i(-2)},
        Pair{of(ValueType::kUint8), 16, "0012", u(18)},
        Pair{of(ValueType::kInt16), 16, "8000", i(-32768)},
        Pair{of(ValueType::kInt16), 16, "7FFF", i(32767)},
        Pair{of(ValueType::kUint16), 16, "FFFF", u(65535)},
        Pair{of(ValueType::kInt32), 16, "FFFF FFFE", i(-2)},
        Pair{of(ValueType::kUint32), 16, "1234 5678", u(0x12345678)},
        Pair{ordered(ValueType::kUint32, kLow, ByteOrder::kBigEndian), 16, "5678 1234",
             u(0x12345678)},
        Pair{ordered(ValueType::kUint32, kBig, kSwapped), 16, "3412 7856", u(0x12345678)},
        Pair{ordered(ValueType::kUint32, kLow, kSwapped), 16, "7856 3412", u(0x12345678)},
        Pair{ordered(ValueType::kUint16, kLow, kSwapped), 16, "3412", u(0x1234)},
        Pair{ordered(ValueType::kUint64, kLow, ByteOrder::kBigEndian), 16, "7788 5566 3344 1122",
             u(0x1122334455667788)},
        Pair{of(ValueType::kInt64), 16, "8000 0000 0000 0000", i(INT64_MIN)},
        Pair{of(ValueType::kUint64), 16, "FFFF FFFF FFFF FFFF", u(UINT64_MAX)},
        Pair{of(ValueType::kFloat32), 16, "41C8 0000", Value{25.0}},
        Pair{of(ValueType::kFloat64), 16, "C000 0000 0000 0000", Value{-2.0}},
        Pair{of(ValueType::kBcd16), 16, "9876", u(9876)},
        Pair{of(ValueType::kBcd32), 16, "1234 5678", u(12345678)},
        Pair{ordered(ValueType::kBcd32, kLow, ByteOrder::kBigEndian), 16, "5678 1234", u(12345678)},
        Pair{Encoding{.type = ValueType::kString, .string_bytes = 5}, 16, "4142 4344 4500",
             Value{std::string("ABCDE")}},
        Pair{Encoding{.type = ValueType::kString, .string_bytes = 4, .byte_order = kSwapped}, 16,
             "4241 0043", Value{std::string("ABC")}},
        Pair{
            Encoding{.type = ValueType::kString, .string_bytes = 4, .layout = TextLayout::kCounted},
            8, "04 03 41 42 43 00", Value{std::string("ABC")}},
        Pair{
            Encoding{.type = ValueType::kString, .string_bytes = 2, .layout = TextLayout::kCounted},
            8, "02 00 00 00", Value{std::string()}}));

INSTANTIATE_TEST_SUITE_P(
    BitsBytesAndWiderItems, BothWays,
    testing::Values(Pair{of(ValueType::kBool), 1, "01", Value{true}},
                    Pair{of(ValueType::kBool), 16, "0000", Value{false}},
                    Pair{of(ValueType::kUint32), 8, "12 34 56 78", u(0x12345678)},
                    Pair{of(ValueType::kUint16), 32, "0000 8000", u(0x8000)},
                    Pair{of(ValueType::kInt16), 32, "FFFF 8000", i(-32768)},
                    Pair{of(ValueType::kInt32), 64, "FFFFFFFF FFFFFFFF", i(-1)},
                    Pair{of(ValueType::kUint16), 1,
                         "01 00 01 00 00 00 00 00 00 00 00 00 00 00 00 01", u(0x8005)},
                    Pair{Encoding{.type = ValueType::kString, .string_bytes = 1}, 1,
                         "01 00 00 00 00 00 01 00", Value{std::string("A")}}));

INSTANTIATE_TEST_SUITE_P(
    Scaled, BothWays,
    testing::Values(
        Pair{Encoding{.type = ValueType::kInt16, .scale = 0.1}, 16, "007B", Value{12.3}},
        Pair{Encoding{.type = ValueType::kInt16, .scale = 0.001}, 16, "8001", Value{-32.767}},
        Pair{Encoding{.type = ValueType::kUint16, .scale = 0.5, .offset = -40}, 16, "00A1",
             Value{40.5}},
        // no decimals: divided by 3, multiplied by 2/3
        Pair{Encoding{.type = ValueType::kInt16, .scale = 1.0 / 3}, 16, "0005", Value{5 / 3.0}},
        Pair{Encoding{.type = ValueType::kInt16, .scale = 2.0 / 3}, 16, "0005",
             Value{5 * (2.0 / 3)}},
        Pair{Encoding{.type = ValueType::kUint16, .scale = -2, .offset = 10}, 16, "0003",
             Value{4.0}},
        Pair{Encoding{.type = ValueType::kFloat32, .scale = 2}, 16, "41C8 0000", Value{50.0}},
        Pair{Encoding{.type = ValueType::kBcd16, .scale = 0.01}, 16, "1234", Value{12.34}}));

TEST(ValueCodec, BitOfAWordIsReadAndGivenAsItsMask) {
  const Encoding bit9{.type = ValueType::kBool, .bit = 9};
  EXPECT_EQ(decode_value(bit9, 16, hex("0200")), Value{true});
  EXPECT_EQ(decode_value(bit9, 16, hex("FDFF")), Value{false});
  EXPECT_EQ(encode_value(bit9, 16, Value{true}), hex("0200"));
  EXPECT_EQ(encode_value(bit9, 16, Value{false}), hex("0000"));
  Bytes item = hex("1234");
  merge_bit(item, 9, false);
  EXPECT_EQ(item, hex("1034"));
  merge_bit(item, 0, true);
  EXPECT_EQ(item, hex("1035"));
}

TEST(ValueCodec, AByteOfAnItemIsReadAloneAndGivenAmongZeros) {
  Encoding byte = of(ValueType::kInt8);
  byte.bit = 8;
  EXPECT_EQ(decode_value(byte, 16, hex("FE12")), i(-2));
  EXPECT_EQ(to_hex(*encode_value(byte, 16, i(-2))), to_hex(hex("FE00")));
  byte.bit = 0;
  EXPECT_EQ(decode_value(byte, 16, hex("FE12")), i(0x12));
  EXPECT_EQ(to_hex(*encode_value(byte, 16, i(-2))), to_hex(hex("00FE")));
  byte.bit = 16;
  EXPECT_EQ(decode_value(byte, 32, hex("01FE0203")), i(-2));
  byte.type = ValueType::kBcd8;
  EXPECT_EQ(decode_value(byte, 32, hex("01420203")), u(42));
  EXPECT_FALSE(decode_value(byte, 32, hex("014A0203")));
}

TEST(ValueCodec, WhatAByteCannotHoldIsARangeFault) {
  EXPECT_EQ(encode_value(of(ValueType::kInt8), 8, i(128)).error(), Cause::kRange);
  EXPECT_EQ(encode_value(of(ValueType::kInt8), 8, i(-129)).error(), Cause::kRange);
  EXPECT_EQ(encode_value(of(ValueType::kUint8), 8, i(256)).error(), Cause::kRange);
  EXPECT_EQ(encode_value(of(ValueType::kBcd8), 8, i(100)).error(), Cause::kRange);
  EXPECT_EQ(decode_value(of(ValueType::kUint8), 16, hex("0112")).error(), Cause::kRange)
      << "more than the byte would show";
}

// A CPU does not change the characters after the actual length; an actual length beyond the maximum
// shows that the PLC's string is longer than the type.
TEST(ValueCodec, ACountedStringHasItsActualLength) {
  const Encoding counted{
      .type = ValueType::kString, .string_bytes = 3, .layout = TextLayout::kCounted};
  EXPECT_EQ(decode_value(counted, 8, hex("0301415A5A")), Value{std::string("A")});
  EXPECT_EQ(decode_value(counted, 8, hex("FEFE414243")), Value{std::string("ABC")});
}

TEST(ValueCodec, ABitBeyondTheItemIsARangeFault) {
  EXPECT_EQ(decode_value({.type = ValueType::kBool, .bit = 16}, 16, hex("FFFF")),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(encode_value({.type = ValueType::kBool, .bit = 8}, 8, Value{true}),
            tl::unexpected(Cause::kRange));
}

TEST(ValueCodec, RawDataWithoutMeaningIsARangeFault) {
  EXPECT_EQ(decode_value(of(ValueType::kFloat32), 16, hex("7FC0 0000")),
            tl::unexpected(Cause::kRange));  // NaN
  EXPECT_EQ(decode_value(of(ValueType::kFloat32), 16, hex("FF80 0000")),
            tl::unexpected(Cause::kRange));  // -inf
  EXPECT_EQ(decode_value(of(ValueType::kFloat64), 16, hex("7FF0 0000 0000 0000")),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(decode_value(of(ValueType::kBcd16), 16, hex("12A4")), tl::unexpected(Cause::kRange));
  EXPECT_EQ(decode_value(of(ValueType::kBcd32), 16, hex("F000 0000")),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(decode_value(of(ValueType::kUint16), 32, hex("0001 0000")),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(decode_value(of(ValueType::kInt16), 32, hex("0000 8000")),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(
      decode_value({.type = ValueType::kFloat64, .scale = 1e300}, 16, hex("7FE0 0000 0000 0000")),
      tl::unexpected(Cause::kRange));
}

TEST(ValueCodec, WhatDoesNotFitIsARangeFaultAndNeverWraps) {
  const auto fault = [](ValueType type, const Value& value) {
    return encode_value(of(type), 16, value) == tl::unexpected(Cause::kRange);
  };
  EXPECT_TRUE(fault(ValueType::kInt16, i(32768)));
  EXPECT_TRUE(fault(ValueType::kInt16, i(-32769)));
  EXPECT_TRUE(fault(ValueType::kUint16, i(-1)));
  EXPECT_TRUE(fault(ValueType::kUint16, u(65536)));
  EXPECT_TRUE(fault(ValueType::kUint32, Value{4294967296.0}));
  EXPECT_TRUE(fault(ValueType::kInt64, u(UINT64_MAX)));
  EXPECT_TRUE(fault(ValueType::kInt64, Value{9223372036854775808.0}));
  EXPECT_TRUE(fault(ValueType::kUint64, Value{18446744073709551616.0}));
  EXPECT_TRUE(fault(ValueType::kUint64, i(-1)));
  EXPECT_TRUE(fault(ValueType::kBcd16, u(10000)));
  EXPECT_TRUE(fault(ValueType::kBcd32, i(-1)));
  EXPECT_TRUE(fault(ValueType::kBcd32, u(100'000'000)));
  EXPECT_TRUE(fault(ValueType::kFloat32, Value{3.5e38}));
  EXPECT_TRUE(fault(ValueType::kFloat32, Value{std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(fault(ValueType::kFloat64, Value{std::numeric_limits<double>::infinity()}));
  EXPECT_TRUE(fault(ValueType::kUint16, Value{std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(fault(ValueType::kBool, i(2)));
  EXPECT_EQ(encode_value({.type = ValueType::kInt16, .scale = 0.1}, 16, Value{3276.8}),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(encode_value({.type = ValueType::kInt16, .scale = 0.0, .offset = 1}, 16, Value{2.0}),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(
      encode_value({.type = ValueType::kString, .string_bytes = 2}, 16, Value{std::string("ABC")}),
      tl::unexpected(Cause::kRange));
}

TEST(ValueCodec, AValueOfAnotherKindIsAWrongType) {
  const auto fault = [](ValueType type, const Value& value) {
    return encode_value(of(type), 16, value) == tl::unexpected(Cause::kWrongType);
  };
  EXPECT_TRUE(fault(ValueType::kInt16, Value{std::string("12")}));
  EXPECT_TRUE(fault(ValueType::kInt16, Value{2.5}));
  EXPECT_TRUE(fault(ValueType::kInt16, Value{true}));
  EXPECT_TRUE(fault(ValueType::kFloat32, Value{false}));
  EXPECT_TRUE(fault(ValueType::kBool, Value{std::string("true")}));
  EXPECT_EQ(encode_value({.type = ValueType::kString, .string_bytes = 2}, 16, i(1)),
            tl::unexpected(Cause::kWrongType));
}

TEST(ValueCodec, ScaledValuesAreRoundedToTheNearestRaw) {
  EXPECT_EQ(encode_value({.type = ValueType::kInt16, .scale = 0.1}, 16, Value{0.3}), hex("0003"));
  EXPECT_EQ(encode_value({.type = ValueType::kInt16, .scale = 0.1}, 16, Value{0.26}), hex("0003"));
  EXPECT_EQ(encode_value({.type = ValueType::kInt16, .scale = 0.1}, 16, i(2)), hex("0014"));
}

// Regression: 7 * 0.3 was printed as 2.0999999999999996.
TEST(ValueCodec, ScaledIntegersHaveTheDecimalsThatUsersExpect) {
  const auto shown = [](double scale, double offset, std::int16_t raw) {
    const auto bits = static_cast<std::uint16_t>(raw);
    const auto value =
        decode_value({.type = ValueType::kInt16, .scale = scale, .offset = offset}, 16,
                     Bytes{static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits)});
    return value ? to_text(*value) : "fault";
  };
  EXPECT_EQ(shown(0.3, 0, 7), "2.1");
  EXPECT_EQ(shown(0.1, 0.1, 7), "0.8");
  EXPECT_EQ(shown(-0.07, 273.15, 3), "272.94");
  EXPECT_EQ(shown(-0.3, 0, 0), "0");
  for (int raw = -3276; raw <= 3276; ++raw) {
    const int tenths = 3 * raw + 401;  // of raw * 0.3 + 40.1
    const std::string whole = std::to_string(std::abs(tenths) / 10);
    const std::string part = tenths % 10 == 0 ? "" : "." + std::to_string(std::abs(tenths) % 10);
    ASSERT_EQ(shown(0.3, 40.1, static_cast<std::int16_t>(raw)),
              (tenths < 0 ? "-" : "") + whole + part);
  }
}

// A fused multiply-add, which rounds once, would give -2.7399986267089833.
TEST(ValueCodec, ScaledFloatsHaveTheSameDigitsOnEveryProcessor) {
  const Encoding encoding{.type = ValueType::kFloat32, .scale = 1.8, .offset = -40};
  const auto value = decode_value(encoding, 16, hex("41A5 999A"));
  ASSERT_TRUE(value.has_value());
  EXPECT_EQ(to_text(*value), "-2.7399986267089815");
}

// Every raw word has a scaled value that converts back to it.
TEST(ValueCodec, EveryScaledWordRoundTrips) {
  for (const double scale : {0.1, 0.01, 0.001, 0.05, 3.0, -0.25, 1.0 / 27648}) {
    const Encoding encoding{.type = ValueType::kInt16, .scale = scale, .offset = -17.3};
    for (unsigned raw = 0; raw <= 0xFFFF; ++raw) {
      const Bytes items{static_cast<std::uint8_t>(raw >> 8), static_cast<std::uint8_t>(raw)};
      const auto value = decode_value(encoding, 16, items);
      ASSERT_TRUE(value.has_value());
      ASSERT_EQ(encode_value(encoding, 16, *value), items) << "scale " << scale << " raw " << raw;
    }
  }
}

TEST(ValueCodec, EveryDecodableImageEncodesToItself) {
  std::mt19937 random(7);
  for (int round = 0; round < 20000; ++round) {
    Encoding encoding{.type = static_cast<ValueType>(random() % 11),
                      .word_order = random() % 2 != 0 ? kLow : kBig,
                      .byte_order = random() % 2 != 0 ? kSwapped : ByteOrder::kBigEndian};
    if (encoding.type == ValueType::kBool) continue;  // several representations of true
    const unsigned item_bits = std::array{1u, 8u, 16u, 32u, 64u}[random() % 5];
    const std::uint32_t count = item_count(encoding, item_bits);
    Bytes items(item_bits <= 8 ? count : count * (item_bits / 8));
    for (auto& byte : items)
      byte = static_cast<std::uint8_t>(item_bits == 1 ? random() % 2 : random());
    const auto value = decode_value(encoding, item_bits, items);
    if (!value) continue;
    const auto again = encode_value(encoding, item_bits, *value);
    ASSERT_TRUE(again.has_value()) << to_text(encoding.type) << " " << to_hex(items);
    ASSERT_EQ(to_hex(*again), to_hex(items)) << to_text(encoding.type);
  }
}

Encoding without(Encoding encoding, std::initializer_list<std::string_view> values) {
  for (const auto value : values)
    encoding.not_available.push_back(parse_not_available(encoding, value).value());
  return encoding;
}

TEST(NotAvailable, IsComparedAfterTheOrderAndBeforeTheScale) {
  const auto none = tl::unexpected(Cause::kNotAvailable);
  const Encoding current = without({.type = ValueType::kUint32, .scale = 0.01}, {"0xFFFFFFFF"});
  EXPECT_EQ(decode_value(current, 16, hex("FFFF FFFF")), none);
  EXPECT_EQ(decode_value(current, 16, hex("FFFF FFFE")), Value{42949672.94});

  const Encoding turned = without(ordered(ValueType::kInt32, kLow, kSwapped), {"0x80000001"});
  EXPECT_EQ(decode_value(turned, 16, hex("0100 0080")), none);
  EXPECT_TRUE(decode_value(turned, 16, hex("8000 0001")).has_value());

  const Encoding several = without(of(ValueType::kInt16), {"0x7FFF", "-32768"});
  for (const auto* items : {"7FFF", "8000"}) {
    EXPECT_EQ(decode_value(several, 16, hex(items)), none) << items;
  }
  EXPECT_EQ(decode_value(several, 16, hex("FFFF")), i(-1));

  const Encoding byte = without({.type = ValueType::kInt8, .bit = 8}, {"-1"});
  EXPECT_EQ(decode_value(byte, 16, hex("FF12")), none);
  EXPECT_EQ(decode_value(byte, 16, hex("12FF")), i(0x12));
}

TEST(NotAvailable, HoldsForBcdTextsAndEveryNan) {
  const auto none = tl::unexpected(Cause::kNotAvailable);
  EXPECT_EQ(decode_value(without(of(ValueType::kBcd16), {"0xFFFF"}), 16, hex("FFFF")), none);
  EXPECT_EQ(decode_value(without(of(ValueType::kBcd16), {"9999"}), 16, hex("9999")), none);
  const Encoding real = without(of(ValueType::kFloat32), {"nan", "-1"});
  for (const auto* items : {"7FC00000", "FFFFFFFF", "7F800001", "BF800000"}) {
    EXPECT_EQ(decode_value(real, 16, hex(items)), none) << items;
  }
  EXPECT_EQ(decode_value(real, 16, hex("7F800000")), tl::unexpected(Cause::kRange)) << "infinite";
  const Encoding text = without({.type = ValueType::kInt16,
                                 .string_bytes = 4,
                                 .text_number = {.kind = TextNumber::Kind::kDecimal}},
                                {"-999"});
  EXPECT_EQ(decode_value(text, 16, hex("2D39 3939")), none);
}

TEST(NotAvailable, IsNotWritten) {
  const auto range = tl::unexpected(Cause::kRange);
  EXPECT_EQ(encode_value(without(of(ValueType::kInt16), {"0x8000"}), 16, i(-32768)), range);
  EXPECT_EQ(encode_value(without({.type = ValueType::kUint16, .scale = 0.1}, {"0xFFFF"}), 16,
                         Value{6553.5}),
            range);
  EXPECT_TRUE(encode_value(without(of(ValueType::kInt16), {"0x8000"}), 16, i(-32767)).has_value());
}

TEST(ValueCodec, ATextInBitsHasEightOfThemForEachCharacter) {
  const Encoding text{.type = ValueType::kString, .string_bytes = 2};
  const auto bits = encode_value(text, 1, Value{std::string("AB")});
  ASSERT_TRUE(bits);
  EXPECT_EQ(bits->size(), 16u);
  EXPECT_EQ(decode_value(text, 1, *bits), Value{std::string("AB")});
}

TEST(ValueCodec, ZeroIsADecimalNumber) {
  for (const ValueType type : {ValueType::kBcd8, ValueType::kBcd16, ValueType::kBcd32}) {
    const unsigned item_bits = type == ValueType::kBcd8 ? 8 : 16;
    const auto items = encode_value(of(type), item_bits, u(0));
    ASSERT_TRUE(items);
    EXPECT_EQ(decode_value(of(type), item_bits, *items), u(0));
  }
}

// The encoding of a type whose exponent is in the item at `distance` from the value.
Encoding with_exponent(ValueType type, std::int32_t distance) {
  return {.type = type, .exponent_distance = distance};
}

TEST(Exponent, IsReadFromAnItemBeforeOrBehindTheValue) {
  const Encoding behind = with_exponent(ValueType::kUint16, 1);
  EXPECT_EQ(item_count(behind, 16), 2u);
  EXPECT_EQ(decode_value(behind, 16, hex("04D2 FFFE")), Value{12.34});
  const Encoding far = with_exponent(ValueType::kInt32, 4);
  EXPECT_EQ(item_count(far, 16), 5u);
  EXPECT_EQ(decode_value(far, 16, hex("FFFF FFFB AAAA BBBB 0003")), Value{-5000.0});
  const Encoding before = with_exponent(ValueType::kUint32, -2);
  EXPECT_EQ(item_count(before, 16), 4u);
  EXPECT_EQ(decode_value(before, 16, hex("FFFF 1234 0000 000F")), Value{1.5});
  EXPECT_EQ(decode_value(with_exponent(ValueType::kBcd16, 1), 16, hex("1234 FFFF")), Value{123.4});
}

// 1234 * 0.01 is 12.340000000000002, and 3 * 0.1 is 0.30000000000000004.
TEST(Exponent, NegativeOnesDivide) {
  const Encoding encoding = with_exponent(ValueType::kInt16, 1);
  EXPECT_EQ(decode_value(encoding, 16, hex("0003 FFFF")), Value{0.3});
  EXPECT_EQ(decode_value(encoding, 16, hex("0001 FFF6")), Value{1e-10});
  EXPECT_EQ(decode_value(encoding, 16, hex("0001 000A")), Value{1e10});
  EXPECT_EQ(decode_value(encoding, 16, hex("8001 0000")), Value{-32767.0}) << "a double always";
}

TEST(Exponent, GoesBeforeScaleAndOffset) {
  Encoding encoding = with_exponent(ValueType::kInt16, 1);
  encoding.scale = 0.1;
  encoding.offset = -40.2;
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 FFFE")), Value{-38.966});
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 0001")), Value{1193.8});
  encoding.scale = 1.0 / 3;
  EXPECT_EQ(decode_value(encoding, 16, hex("0384 FFFE")), Value{3.0 - 40.2});
}

TEST(Exponent, HasTheByteOrderOfItsValueAndNotItsWordOrder) {
  Encoding encoding = ordered(ValueType::kUint32, kLow, kSwapped);
  encoding.exponent_distance = 2;
  EXPECT_EQ(decode_value(encoding, 16, hex("D204 0000 FEFF")), Value{12.34});
}

TEST(Exponent, OneThatIsNotAvailableOrTooLargeMakesTheValueBad) {
  const auto none = tl::unexpected(Cause::kNotAvailable);
  const auto range = tl::unexpected(Cause::kRange);
  const Encoding encoding = without(with_exponent(ValueType::kInt16, 1), {"0x8000"});
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 8000")), none);
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 000B")), range);
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 FFF5")), range);
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 7FFF")), range);
  EXPECT_EQ(decode_value(encoding, 16, hex("04D2 8001")), range);
  EXPECT_EQ(decode_value(encoding, 16, hex("8000 FFFE")), none) << "the value itself";
  EXPECT_EQ(decode_value(encoding, 16, hex("8000 7FFF")), none) << "the value goes first";
  EXPECT_EQ(decode_value(encoding, 32, hex("000004D2 0000FFFE")), range) << "wider than 16 bits";
  EXPECT_EQ(decode_value(encoding, 32, hex("000004D2 FFFFFFFE")), Value{12.34});
}

TEST(Exponent, AValueWithOneIsNotWritten) {
  EXPECT_EQ(encode_value(with_exponent(ValueType::kInt16, 1), 16, Value{12.34}),
            tl::unexpected(Cause::kReadOnly));
}

TEST(ValueCodec, ABoolAcceptsZeroAndOne) {
  const Encoding coil = of(ValueType::kBool);
  for (const Value& on : {Value{true}, i(1), u(1), Value{1.0}})
    EXPECT_EQ(encode_value(coil, 1, on), hex("01")) << to_text(on);
  for (const Value& off : {Value{false}, i(0), u(0), Value{0.0}})
    EXPECT_EQ(encode_value(coil, 1, off), hex("00")) << to_text(off);
  for (const Value& wrong : {i(2), i(-1), Value{0.5}})
    EXPECT_EQ(encode_value(coil, 1, wrong), tl::unexpected(Cause::kRange)) << to_text(wrong);
}

TEST(ValueCodec, WholeDoublesFitIntegersOf64Bits) {
  const auto range = tl::unexpected(Cause::kRange);
  const Encoding wide = of(ValueType::kUint64), integer = of(ValueType::kInt64);
  EXPECT_EQ(encode_value(wide, 16, Value{9223372036854775808.0}), hex("8000 0000 0000 0000"));
  EXPECT_EQ(encode_value(wide, 16, Value{18446744073709551616.0}), range);
  EXPECT_EQ(encode_value(integer, 16, Value{-9223372036854775808.0}), hex("8000 0000 0000 0000"));
  EXPECT_EQ(encode_value(integer, 16, Value{9223372036854775808.0}), range);
  EXPECT_EQ(encode_value(integer, 16, Value{-1e19}), range);
}

TEST(ValueCodec, AFloatAcceptsIntegersAndNoOverflowOfItsScale) {
  EXPECT_EQ(encode_value(of(ValueType::kFloat32), 16, u(25)), hex("41C8 0000"));
  EXPECT_EQ(encode_value(of(ValueType::kFloat32), 16, i(25)), hex("41C8 0000"));
  const Encoding tiny{.type = ValueType::kFloat64, .scale = 1e-300};
  EXPECT_EQ(encode_value(tiny, 16, Value{1e300}), tl::unexpected(Cause::kRange));
}

TEST(ValueCodec, AnOffsetBeyondExactNumbersIsAdded) {
  const Encoding far{.type = ValueType::kInt16, .offset = 9007199254740992.0};
  EXPECT_EQ(decode_value(far, 16, hex("0002")), Value{9007199254740994.0});
  const Encoding steep{.type = ValueType::kInt16, .scale = 9007199254740992.0};
  EXPECT_EQ(decode_value(steep, 16, hex("0002")), Value{18014398509481984.0});
}

TEST(NotAvailable, EveryNanOfADoubleIsOne) {
  const Encoding real = without(of(ValueType::kFloat64), {"nan", "-1"});
  const auto none = tl::unexpected(Cause::kNotAvailable);
  EXPECT_EQ(decode_value(real, 16, hex("FFF8 0000 0000 0001")), none);
  EXPECT_EQ(decode_value(real, 16, hex("BFF0 0000 0000 0000")), none);
  EXPECT_EQ(decode_value(real, 16, hex("4000 0000 0000 0000")), Value{2.0});
}

}  // namespace
}  // namespace fieldcast
