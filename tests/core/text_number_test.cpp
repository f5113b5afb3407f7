#include <gtest/gtest.h>

#include "core/codec/text_codec.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

using Kind = TextNumber::Kind;

constexpr TextNumber kDecimal{.kind = Kind::kDecimal};

Bytes items_of(std::string_view text) {
  Bytes items(text.begin(), text.end());
  if (items.size() % 2 != 0) items.push_back(0);
  return items;
}

tl::expected<Value, Cause> read(ValueType type, TextNumber form, std::string_view text) {
  const Encoding encoding{
      .type = type, .string_bytes = static_cast<std::uint16_t>(text.size()), .text_number = form};
  return decode_value(encoding, 16, items_of(text));
}

std::string written(ValueType type, TextNumber form, std::uint16_t width, const Value& value) {
  const Encoding encoding{.type = type, .string_bytes = width, .text_number = form};
  const auto items = encode_value(encoding, 16, value);
  if (!items) return std::string(to_text(items.error()));
  return {items->begin(), items->begin() + width};
}

std::string by_picture(std::string_view picture, const Value& value) {
  return written(ValueType::kFloat64, text_number_from_picture(picture).value(),
                 static_cast<std::uint16_t>(picture.size()), value);
}

constexpr auto kRange = "value out of range";

TEST(TextNumber, IsReadWithSignBlanksPointAndExponent) {
  const auto real = [](std::string_view text) { return read(ValueType::kFloat64, kDecimal, text); };
  EXPECT_EQ(real("+025.00"), Value{25.0});
  EXPECT_EQ(real("  -25.5"), Value{-25.5});
  EXPECT_EQ(real("-  25.5"), Value{-25.5}) << "weighing indicators";
  EXPECT_EQ(real("25.5   "), Value{25.5});
  EXPECT_EQ(real(std::string_view("25.5\0\0\0", 7)), Value{25.5}) << "a shorter variable text";
  EXPECT_EQ(real("1.5e-03"), Value{0.0015});
  EXPECT_EQ(real("  +7."), Value{7.0});
  EXPECT_EQ(real("    .5"), Value{0.5});
  EXPECT_EQ(read(ValueType::kFloat64, {.kind = Kind::kDecimalComma}, "  25,5"), Value{25.5});
  EXPECT_EQ(read(ValueType::kFloat32, kDecimal, "0000.1"), Value{static_cast<double>(0.1F)});
  EXPECT_EQ(read(ValueType::kInt16, kDecimal, "-00042"), Value{std::int64_t{-42}});
  EXPECT_EQ(read(ValueType::kUint16, kDecimal, "42.000"), Value{std::uint64_t{42}});
  EXPECT_EQ(read(ValueType::kUint64, kDecimal, "18446744073709551615"), Value{UINT64_MAX});
}

TEST(TextNumber, WhatSpellsNoNumberOfTheTypeIsOutOfRange) {
  for (const auto* text : {"      ", "------", "OVER  ", "+-25.0", "1.2.3 ", "12 34 ", "25,5  ",
                           "0x10  ", "nan   ", "inf   ", "1e+   ", "1e999 ", "25.5kg", "+     "})
    EXPECT_EQ(read(ValueType::kFloat64, kDecimal, text), tl::unexpected(Cause::kRange)) << text;
  EXPECT_EQ(read(ValueType::kFloat64, {.kind = Kind::kDecimalComma}, "  25.5"),
            tl::unexpected(Cause::kRange));
  EXPECT_EQ(read(ValueType::kInt16, kDecimal, " 32768"), tl::unexpected(Cause::kRange));
  EXPECT_EQ(read(ValueType::kInt16, kDecimal, "  2.5 "), tl::unexpected(Cause::kRange));
  EXPECT_EQ(read(ValueType::kUint16, kDecimal, "    -1"), tl::unexpected(Cause::kRange));
  EXPECT_EQ(quality_of(Cause::kRange), Quality::kBadRange);
}

TEST(TextNumber, HexIsTheBitsOfTheType) {
  constexpr TextNumber hex{.kind = Kind::kHex};
  EXPECT_EQ(read(ValueType::kUint16, hex, "00ff"), Value{std::uint64_t{255}});
  EXPECT_EQ(read(ValueType::kInt16, hex, "FFE7"), Value{std::int64_t{-25}});
  EXPECT_EQ(read(ValueType::kFloat32, hex, "41C80000"), Value{25.0});
  EXPECT_EQ(read(ValueType::kUint16, hex, "0x1F"), Value{std::uint64_t{31}});
  EXPECT_EQ(read(ValueType::kUint16, hex, " 1Fh"), Value{std::uint64_t{31}});
  for (const auto* text : {"00G0", "    ", "-001", "0x  "})
    EXPECT_EQ(read(ValueType::kUint16, hex, text), tl::unexpected(Cause::kRange)) << text;
  EXPECT_EQ(read(ValueType::kUint16, hex, "10000"), tl::unexpected(Cause::kRange));
  EXPECT_EQ(written(ValueType::kInt16, hex, 4, std::int64_t{-25}), "FFE7");
  EXPECT_EQ(written(ValueType::kUint16, hex, 6, std::int64_t{255}), "0000FF");
  EXPECT_EQ(written(ValueType::kUint16, hex, 2, std::int64_t{256}), kRange);
  EXPECT_EQ(written(ValueType::kFloat32, hex, 8, 25.0), "41C80000");
}

TEST(TextNumber, IsWrittenAsThePictureShows) {
  EXPECT_EQ(by_picture("+000.00", 25.0), "+025.00");
  EXPECT_EQ(by_picture("+000.00", -25.126), "-025.13");
  EXPECT_EQ(by_picture("+000.00", -0.001), "+000.00") << "no minus before nothing";
  EXPECT_EQ(by_picture("000.00", std::int64_t{5}), "005.00");
  EXPECT_EQ(by_picture("000,0", -3.14), "-03,1");
  EXPECT_EQ(by_picture("0000", -42.0), "-042");
  EXPECT_EQ(by_picture("+000.00", 999.999), kRange);
  EXPECT_EQ(by_picture("+000.00", 1000.0), kRange);
  EXPECT_EQ(by_picture("0000", -4200.0), kRange);
  for (const auto* text : {"", "+", "0.", ".0", "0.0.0", "1.0", "00 0", "-00.0", "0,"})
    EXPECT_FALSE(text_number_from_picture(text)) << text;
}

TEST(TextNumber, WithoutAPictureTheWidthIsFilledWithBlanks) {
  const auto real = [](double value, std::uint16_t width = 7) {
    return written(ValueType::kFloat64, kDecimal, width, value);
  };
  EXPECT_EQ(real(25.5), "   25.5");
  EXPECT_EQ(real(-25.5), "  -25.5");
  EXPECT_EQ(real(0.1 + 0.2), "0.30000") << "rounded to what fits";
  EXPECT_EQ(real(99.96, 3), "100");
  EXPECT_EQ(real(999.96, 4), "1000");
  EXPECT_EQ(real(0.0, 1), "0");
  EXPECT_EQ(real(12345678.0), kRange);
  EXPECT_EQ(real(1e300), kRange);
  EXPECT_EQ(real(1e-9), kRange) << "nothing of it would be left";
  EXPECT_EQ(real(-0.5, 2), kRange);
  EXPECT_EQ(written(ValueType::kFloat32, kDecimal, 7, static_cast<double>(0.1F)), "    0.1");
  EXPECT_EQ(written(ValueType::kFloat64, {.kind = Kind::kDecimalComma}, 7, 25.5), "   25,5");
  EXPECT_EQ(written(ValueType::kInt32, kDecimal, 5, std::int64_t{-1234}), "-1234");
  EXPECT_EQ(written(ValueType::kInt32, kDecimal, 5, std::int64_t{-12345}), kRange);
}

TEST(TextNumber, HasScaleOffsetAndByteOrderAsOthersHave) {
  const Encoding swapped{.type = ValueType::kInt16,
                         .string_bytes = 4,
                         .byte_order = ByteOrder::kLittleEndian,
                         .scale = 0.1,
                         .offset = -1,
                         .text_number = kDecimal};
  EXPECT_EQ(item_count(swapped, 16), 2u);
  EXPECT_EQ(decode_value(swapped, 16, items_of("2100")), Value{119.0}) << "1200 * 0.1 - 1";
  EXPECT_EQ(encode_value(swapped, 16, Value{119.0}), items_of("2100"));
}

}  // namespace
}  // namespace fieldcast
