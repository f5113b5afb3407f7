#include "core/base/time.hpp"

#include <gtest/gtest.h>

#include "core/base/cause.hpp"
#include "core/base/duration_text.hpp"
#include "core/base/value.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(Saturated, SumsAndDifferencesStopAtTheEndsOfTheRange) {
  EXPECT_EQ(saturated_sum(2, 3), 5);
  EXPECT_EQ(saturated_sum(INT64_MAX, 1), INT64_MAX);
  EXPECT_EQ(saturated_sum(INT64_MIN, -1), INT64_MIN);
  EXPECT_EQ(saturated_difference(2, 3), -1);
  EXPECT_EQ(saturated_difference(0, INT64_MIN), INT64_MAX);
  EXPECT_EQ(saturated_difference(-2, INT64_MAX), INT64_MIN);
}

constexpr UtcMapping kMapping{Instant{100s}, UtcTime{1'000}};

TEST(UtcMappingTest, ConvertsBothWays) {
  EXPECT_EQ(kMapping.to_utc(Instant{100s + 5ns}), UtcTime{1'005});
  EXPECT_EQ(kMapping.to_utc(Instant{100s - 5ns}), UtcTime{995});
  EXPECT_EQ(kMapping.to_instant(UtcTime{1'005}), Instant{100s + 5ns});
  EXPECT_EQ(kMapping.to_instant(UtcTime{995}), Instant{100s - 5ns});
  EXPECT_EQ(kMapping.to_utc(kLongAgo), UtcTime{});
  EXPECT_EQ(kMapping.to_utc(kNever), UtcTime{});
}

TEST(UtcMappingTest, SaturatesBeyondTheRange) {
  constexpr UtcMapping late{Instant{}, UtcTime{INT64_MAX - 10}}, early{Instant{}, UtcTime{-100}};
  EXPECT_EQ(late.to_utc(Instant{11ns}), UtcTime{INT64_MAX});
  EXPECT_EQ(early.to_utc(kLongAgo + 1ns), UtcTime{INT64_MIN});
  EXPECT_EQ(late.to_instant(UtcTime{INT64_MIN}), kLongAgo);
  EXPECT_EQ(early.to_instant(UtcTime{INT64_MAX}), kNever);
  EXPECT_EQ(kMapping.to_instant(UtcTime{INT64_MAX}), kNever);
  constexpr UtcMapping past{Instant{-100s}, UtcTime{}};
  EXPECT_EQ(past.to_instant(UtcTime{INT64_MIN + 1}), kLongAgo);
}

TEST(UtcMappingTest, IsKeptWhileANewerOneDiffersByNoMoreThanTheReadingOfClocks) {
  const auto follows = [](std::int64_t apart) {
    const UtcMapping newer{Instant{101s}, UtcTime{1'000 + 1'000'000'000 + apart}};
    return kMapping.followed_by(newer).instant == newer.instant;
  };
  EXPECT_FALSE(follows(0));
  EXPECT_FALSE(follows(100'000));
  EXPECT_FALSE(follows(-100'000));
  EXPECT_TRUE(follows(100'001));
  EXPECT_TRUE(follows(-100'001));
  EXPECT_EQ(kMapping.followed_by({Instant{101s}, UtcTime{INT64_MIN}}).utc, UtcTime{INT64_MIN});
}

TEST(DurationText, ChangesTheUnitAtItsLimit) {
  EXPECT_EQ(to_text(Duration{-90s}), "-90s");
  EXPECT_EQ(to_text(Duration{999us}), "999us");
  EXPECT_EQ(to_text(Duration{1ms}), "1ms");
  EXPECT_EQ(to_text(Duration{119s}), "119s");
  EXPECT_EQ(to_text(Duration{2min}), "2min");
  EXPECT_EQ(to_text(Duration{60min}), "1h");
  EXPECT_EQ(to_text(Duration{47h}), "47h");
  EXPECT_EQ(to_text(Duration{48h}), "2d");
  EXPECT_EQ(from_seconds(1.5), Duration{1500ms});
}

TEST(ValueNumber, OnlyNumbersHaveOne) {
  EXPECT_EQ(as_number(2.5), 2.5);
  EXPECT_EQ(as_number(std::int64_t{-3}), -3.0);
  EXPECT_EQ(as_number(std::uint64_t{7}), 7.0);
  EXPECT_EQ(as_number(true), std::nullopt);
  EXPECT_EQ(as_number(std::string("1")), std::nullopt);
}

TEST(Causes, AreFoundByTheirNames) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(Cause::kCount); ++i)
    EXPECT_EQ(cause_named(to_name(static_cast<Cause>(i))), static_cast<Cause>(i));
  EXPECT_EQ(cause_named("NO_SUCH_CAUSE"), Cause::kNone);
}

TEST(CauseCounters, ACountMovesToASecondCause) {
  CauseCounters counters;
  counters.add(Cause::kTruncated, 3);
  counters.move(Cause::kTruncated, Cause::kForeign);
  EXPECT_EQ(counters[Cause::kTruncated], 2u);
  EXPECT_EQ(counters[Cause::kForeign], 1u);
}

TEST(DurationText, UnitsInCapitalsAreUnderstood) {
  const auto meant = [](std::string_view text) {
    return read_duration(text, {1ms, 240h}).error().suggestion;
  };
  EXPECT_EQ(meant("1DAY"), "1d");
  EXPECT_EQ(meant("5 Seconds"), "5s");
}

}  // namespace
}  // namespace fieldcast
