#include "core/codec/date_time.hpp"

#include <gtest/gtest.h>

#include "core/codec/value_codec.hpp"

namespace fieldcast::test {
namespace {

using enum TextLayout;

Bytes bytes(std::string_view digits) { return *from_hex(digits); }

struct Pair {
  TextLayout layout;
  std::string_view stored;
  std::string_view text;
};
class DateTimeBothWays : public testing::TestWithParam<Pair> {};

TEST_P(DateTimeBothWays, IsTheSameDate) {
  const auto& [layout, stored, text] = GetParam();
  EXPECT_EQ(read_date_time(layout, bytes(stored)), std::string(text));
  EXPECT_EQ(write_date_time(layout, text), bytes(stored));
  EXPECT_EQ(text.size(), date_time_characters(layout));
  EXPECT_EQ(bytes(stored).size(), date_time_bytes(layout));
}

// DT#1993-12-25-8:12:34.567 is the example of A5E02789666-01, 27.3.3.2, where the weekday is
// Thursday; it was a Saturday. DTL#2008-12-16-20:30:20.250 is that of A5E02486680-AK, table 5-33.
INSTANTIATE_TEST_SUITE_P(
    S7, DateTimeBothWays,
    testing::Values(Pair{kDateAndTime, "93 12 25 08 12 34 56 77", "1993-12-25T08:12:34.567"},
                    Pair{kDateAndTime, "90 01 01 00 00 00 00 02", "1990-01-01T00:00:00.000"},
                    Pair{kDateAndTime, "89 12 31 23 59 59 99 97", "2089-12-31T23:59:59.999"},
                    Pair{kDateAndTime, "00 02 29 06 30 00 00 13", "2000-02-29T06:30:00.001"},
                    Pair{kDtl, "07D8 0C 10 03 14 1E 14 0EE6B280", "2008-12-16T20:30:20.250000000"},
                    Pair{kDtl, "07EA 0B 1C 07 0A 0F 00 075BCD15", "2026-11-28T10:15:00.123456789"},
                    Pair{kDtl, "07B2 01 01 05 00 00 00 00000000", "1970-01-01T00:00:00.000000000"},
                    Pair{kDtl, "09FA 0C 1F 03 17 3B 3B 3B9AC9FF",
                         "2554-12-31T23:59:59.999999999"}));

TEST(DateTime, AFieldOutsideItsRangeIsARangeFault) {
  const Bytes dtl = bytes("07EA 0B 1C 07 0A 0F 00 00000000");
  const Bytes date_and_time = bytes("26 11 28 10 15 00 00 07");
  const auto with = [](Bytes stored, std::size_t at, std::uint8_t byte) {
    stored[at] = byte;
    return stored;
  };
  for (const auto& [at, byte] : {std::pair{0, 0x07 - 1},
                                 {0, 0x0A},
                                 {0, 0xFF},
                                 {2, 0},
                                 {2, 13},
                                 {3, 0},
                                 {3, 31},
                                 {5, 24},
                                 {6, 60},
                                 {7, 60},
                                 {8, 0x3C}}) {
    const auto stored = with(dtl, static_cast<std::size_t>(at), static_cast<std::uint8_t>(byte));
    EXPECT_EQ(read_date_time(kDtl, stored), tl::unexpected(Cause::kRange)) << to_hex(stored);
  }
  for (const auto& [at, byte] : {std::pair{0, 0xA0},
                                 {1, 0x13},
                                 {1, 0},
                                 {1, 0x0B},
                                 {2, 0x31},
                                 {3, 0x24},
                                 {4, 0x60},
                                 {5, 0x60},
                                 {6, 0x0A},
                                 {7, 0xA7}}) {
    const auto stored =
        with(date_and_time, static_cast<std::size_t>(at), static_cast<std::uint8_t>(byte));
    EXPECT_EQ(read_date_time(kDateAndTime, stored), tl::unexpected(Cause::kRange))
        << to_hex(stored);
  }
  EXPECT_EQ(read_date_time(kDtl, Bytes(12)), tl::unexpected(Cause::kRange)) << "never set";
  EXPECT_TRUE(read_date_time(kDtl, with(dtl, 4, 0))) << "the weekday is not checked";
  EXPECT_TRUE(read_date_time(kDateAndTime, with(date_and_time, 7, 0x01)));
}

TEST(DateTime, AWrittenTextMayHaveAShorterFraction) {
  EXPECT_EQ(write_date_time(kDtl, "2026-11-28T10:15:00"), bytes("07EA 0B 1C 07 0A 0F 00 00000000"));
  EXPECT_EQ(write_date_time(kDtl, "2026-11-28T10:15:00.5"),
            bytes("07EA 0B 1C 07 0A 0F 00 1DCD6500"));
  EXPECT_EQ(write_date_time(kDateAndTime, "2026-11-28T10:15:00.25"),
            bytes("26 11 28 10 15 00 25 07"));
}

TEST(DateTime, ATextThatIsNoDateOfTheCpuIsARangeFault) {
  for (const std::string_view text :
       {"", "2026-11-28", "2026-11-28 10:15:00", "2026-11-28T10:15:00Z", "2026-11-28T10:15:00.",
        "2026-11-28T10:15:00+01:00", "2026-11-28T10:15:00.1234567890", "2026-02-29T10:15:00",
        "2026-13-28T10:15:00", "2026-11-28T24:00:00", "1969-12-31T23:59:59", "2555-01-01T00:00:00",
        "+026-11-28T10:15:00", "2026-11-28T10:15: 1", "202:-11-28T10:15:00"}) {
    EXPECT_EQ(write_date_time(kDtl, text), tl::unexpected(Cause::kRange)) << text;
  }
  for (const std::string_view text :
       {"1989-12-31T23:59:59", "2090-01-01T00:00:00", "2026-11-28T10:15:00.1234"}) {
    EXPECT_EQ(write_date_time(kDateAndTime, text), tl::unexpected(Cause::kRange)) << text;
  }
}

TEST(DateTime, IsTheTextOfAChannel) {
  const Encoding dtl{.type = ValueType::kString, .string_bytes = 29, .layout = kDtl};
  const Bytes stored = bytes("07EA 0B 1C 07 0A 0F 00 00000001");
  EXPECT_EQ(item_count(dtl, 8), 12u);
  EXPECT_EQ(decode_value(dtl, 8, stored), Value{std::string("2026-11-28T10:15:00.000000001")});
  EXPECT_EQ(encode_value(dtl, 8, Value{std::string("2026-11-28T10:15:00.000000001")}), stored);
  EXPECT_EQ(encode_value(dtl, 8, Value{1.0}), tl::unexpected(Cause::kWrongType));
}

}  // namespace
}  // namespace fieldcast::test
