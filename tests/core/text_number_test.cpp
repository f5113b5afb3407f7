#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/duration_text.hpp"
#include "core/base/value.hpp"
#include "core/codec/text_codec.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_EQ(real(99.96, 4), " 100") << "with a decimal it would have five characters";
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

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NumberText, HasNoExponentWhereUsersExpectNone) {
  EXPECT_EQ(number_text(100000.0), "100000");
  EXPECT_EQ(number_text(0.0001), "0.0001");
  EXPECT_EQ(number_text(9999999999999998.0), "9999999999999998");
  EXPECT_EQ(number_text(1e16), "1e+16");
  EXPECT_EQ(number_text(0.00001), "1e-05");
  EXPECT_EQ(number_text(-2.5e-7), "-2.5e-07");
  EXPECT_EQ(number_text(25.0), "25");
  EXPECT_EQ(number_text(0.0), "0");
}

TEST(NumberText, NoNumberAndInfinitiesHaveOneSpelling) {
  EXPECT_EQ(number_text(std::nan("")), "nan");
  EXPECT_EQ(number_text(-std::nan("")), "nan");
  EXPECT_EQ(number_text(kInfinity), "inf");
  EXPECT_EQ(float32_text(-kInfinity), "-inf");
  EXPECT_EQ(float32_text(std::nan("")), "nan");
}

TEST(NumberText, OfAFloatHasTheDigitsOfAFloat) {
  EXPECT_EQ(float32_text(static_cast<double>(0.1F)), "0.1");
  EXPECT_EQ(number_text(static_cast<double>(0.1F)), "0.10000000149011612");
  EXPECT_EQ(float32_text(0.1), "0.1") << "scaled: no float any more, every digit of the double";
  EXPECT_EQ(float32_text(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(float32_text(1e300), "1e+300");
}

TEST(NumberText, ReadsBackAsTheSameNumber) {
  std::mt19937_64 random{7};
  unsigned seen = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto number = std::bit_cast<double>(random());
    if (!std::isfinite(number)) continue;
    ++seen;
    const std::string text = number_text(number);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    ASSERT_EQ(back, number) << text;
    ASSERT_EQ(to_text(Value{number}), text);
    const auto single = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isfinite(single)) continue;
    const std::string short_text = float32_text(static_cast<double>(single));
    float again = 0;
    std::from_chars(short_text.data(), short_text.data() + short_text.size(), again);
    ASSERT_EQ(again, single) << short_text;
  }
  EXPECT_GT(seen, 190'000u);
}

TEST(DurationText, IsANumberDirectlyFollowedByItsUnit) {
  EXPECT_EQ(duration_from("500us"), Duration{500us});
  EXPECT_EQ(duration_from("0.25ms"), Duration{250us});
  EXPECT_EQ(duration_from("20ms"), Duration{20ms});
  EXPECT_EQ(duration_from("1.5s"), Duration{1500ms});
  EXPECT_EQ(duration_from("30m"), Duration{30min});
  EXPECT_EQ(duration_from("30min"), Duration{30min});
  EXPECT_EQ(duration_from("1h"), Duration{1h});
  EXPECT_EQ(duration_from("30d"), Duration{720h});
  EXPECT_EQ(duration_from("0s"), Duration{});
  for (const auto* text : {"", "s", "m", "1", "1 s", "-1s", "+1s", "1.s", ".5s", "1.2.3s", "1e3s",
                           "0x1s", "infs", "nans", "1y", "1sms", "1hh", "1S", "1h30m"})
    EXPECT_EQ(duration_from(text), std::nullopt) << text;
}

TEST(DurationText, TooLargeForItsTypeIsLongerThanEveryLimit) {
  for (const auto* text : {"9999999999999s", "99999999999999999999999999min", "400000d"})
    EXPECT_GT(duration_from(text), Duration{24h * 36'500}) << text;
  EXPECT_GT(duration_from(std::string(400, '9') + "us"), Duration{24h * 36'500});
}

TEST(DurationText, WhatIsPrintedReadsBackAsTheSame) {
  for (const Duration each :
       {Duration{}, Duration{1us}, Duration{1500us}, Duration{999'999us}, Duration{1s},
        Duration{60s}, Duration{90s}, Duration{2min}, Duration{1h}, Duration{90min}, Duration{24h},
        Duration{36h}, Duration{48h}, Duration{25h + 1s}, Duration{720h}, Duration{24h * 36'500}})
    EXPECT_EQ(duration_from(to_text(each)), each) << to_text(each);
}

TEST(DurationText, FaultsSayWhatIsWrongAndWhatWasMeant) {
  const auto fault = [](std::string_view text) {
    const auto read = read_duration(text, {1ms, 24h});
    return read ? "none" : fault_text(text, read.error());
  };
  const std::string form = "; allowed: a number with us, ms, s, min, h or d, 1ms to 24h";
  EXPECT_EQ(fault("1ms"), "none");
  EXPECT_EQ(fault("24h"), "none");
  EXPECT_EQ(fault("0s"), "'0s' is too short; allowed: 1ms to 24h");
  EXPECT_EQ(fault("2d"), "'2d' is too long; allowed: 1ms to 24h");
  EXPECT_EQ(fault("500"), "'500' has no unit" + form + "; did you mean 500ms?");
  EXPECT_EQ(fault("2"), "'2' has no unit" + form + "; did you mean 2s?");
  EXPECT_EQ(fault("-1s"), "'-1s' is negative" + form);
  EXPECT_EQ(fault("1 hour"), "'1 hour' is no duration" + form + "; did you mean 1h?");
  EXPECT_EQ(fault("1,5s"), "'1,5s' is no duration" + form + "; did you mean 1.5s?");
  EXPECT_EQ(fault(".5s"), "'.5s' is no duration" + form + "; did you mean 0.5s?");
  EXPECT_EQ(fault("9days"), "'9days' is no duration" + form) << "9d would be too long";
  EXPECT_EQ(fault("soon"), "'soon' is no duration" + form);
}

TEST(DurationText, ANumberAloneIsSecondsWhereThatIsSaid) {
  EXPECT_EQ(read_duration("20", {0s, 1h, true}), Duration{20s});
  EXPECT_EQ(read_duration("0", {0s, 1h, true}), Duration{});
  EXPECT_EQ(read_duration("0.5", {0s, 1h, true}), Duration{500ms});
  EXPECT_FALSE(read_duration("-1", {0s, 1h, true}));
}

TEST(DurationText, NoUnitIsSuggestedWhereNoneFits) {
  const auto suggestion = [](std::string_view text) {
    return read_duration(text, {2h, 3h}).error().suggestion;
  };
  EXPECT_EQ(suggestion("500"), "");
  EXPECT_EQ(suggestion("150"), "150min");
  EXPECT_EQ(suggestion("2"), "2h");
  EXPECT_EQ(fault_text("-5", read_duration("-5", {2h, 3h}).error()).substr(0, 16),
            "'-5' is negative");
  EXPECT_EQ(fault_text("-x", read_duration("-x", {2h, 3h}).error()).substr(0, 19),
            "'-x' is no duration");
}

TEST(TextNumber, PaddingIsBlanksTabsAndZeroBytes) {
  EXPECT_EQ(read(ValueType::kInt16, kDecimal, "\t42\t"), Value{std::int64_t{42}});
  EXPECT_EQ(read(ValueType::kInt16, kDecimal,
                 std::string_view("\0\0"
                                  "42",
                                  4)),
            Value{std::int64_t{42}});
}

TEST(TextNumber, WholeNumbersHaveTheLimitsOfTheirTypes) {
  const auto range = tl::unexpected(Cause::kRange);
  EXPECT_EQ(read(ValueType::kInt64, kDecimal, "-9223372036854775808"), Value{INT64_MIN});
  EXPECT_EQ(read(ValueType::kInt64, kDecimal, "-9223372036854775809"), range);
  EXPECT_EQ(read(ValueType::kInt64, kDecimal, "9223372036854775808"), range);
  EXPECT_EQ(read(ValueType::kUint64, kDecimal, "18446744073709551616"), range);
  EXPECT_EQ(read(ValueType::kFloat64, kDecimal, std::string(64, '0')), Value{0.0});
  EXPECT_EQ(read(ValueType::kFloat64, kDecimal, std::string(65, '0')), range);
  EXPECT_EQ(read(ValueType::kFloat64, kDecimal, "1.5E3x"), range);
  EXPECT_EQ(read(ValueType::kFloat64, kDecimal, "1.5E3"), Value{1500.0});
}

TEST(TextNumber, HexHasBothSpellingsOfItsMarks) {
  constexpr TextNumber hex{.kind = Kind::kHex};
  EXPECT_EQ(read(ValueType::kUint16, hex, "0X1F"), Value{std::uint64_t{31}});
  EXPECT_EQ(read(ValueType::kUint16, hex, "1FH"), Value{std::uint64_t{31}});
  EXPECT_EQ(read(ValueType::kUint64, hex, "FFFFFFFFFFFFFFFF"), Value{UINT64_MAX});
  EXPECT_EQ(read(ValueType::kUint64, hex, "10000000000000000"), tl::unexpected(Cause::kRange));
}

TEST(TextNumber, AnIntegerGetsTheDecimalsOfThePicture) {
  const TextNumber form = text_number_from_picture("000.00").value();
  EXPECT_EQ(written(ValueType::kInt16, form, 6, std::int64_t{5}), "005.00");
  EXPECT_EQ(written(ValueType::kUint16, form, 6, std::uint64_t{0}), "000.00");
  EXPECT_EQ(written(ValueType::kInt16, form, 6, std::int64_t{0}), "000.00");
  EXPECT_EQ(written(ValueType::kUint64, form, 6, std::uint64_t{5}), "005.00");
  EXPECT_EQ(written(ValueType::kInt16, form, 6, std::int64_t{-25}), "-25.00");
}

TEST(TextNumber, WithoutACharacterNothingIsWritten) {
  EXPECT_EQ(write_decimal(kDecimal, 0, Value{1.0}, false), tl::unexpected(Cause::kRange));
}

TEST(TextNumber, APictureHasAtMost32DigitsOnEachSide) {
  EXPECT_TRUE(text_number_from_picture(std::string(32, '0') + '.' + std::string(32, '0')));
  EXPECT_FALSE(text_number_from_picture(std::string(33, '0')));
  EXPECT_FALSE(text_number_from_picture("0." + std::string(33, '0')));
}

}  // namespace
}  // namespace fieldcast
