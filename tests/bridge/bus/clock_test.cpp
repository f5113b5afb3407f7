#include "bridge/base/clock.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

TEST(Clocks, BothReadingsAreOfThisMoment) {
  const Instant before = steady_now();
  const auto wall_before =
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  const UtcMapping mapping = read_clocks();
  const auto wall_after =
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
          .count();
  EXPECT_GE(mapping.instant, before);
  EXPECT_LE(mapping.instant, steady_now());
  EXPECT_GE(mapping.utc.nanoseconds, wall_before);
  EXPECT_LE(mapping.utc.nanoseconds, wall_after);
}

TEST(Clock, OneInstantIsReportedAsOneTimeUntilTheClockIsSet) {
  using namespace std::chrono_literals;
  const UtcMapping first{Instant{100s}, UtcTime{1'000'000'000}};
  const UtcMapping same = first.followed_by({Instant{101s}, UtcTime{2'000'000'003}});
  EXPECT_EQ(same.to_utc(Instant{100s}).nanoseconds, 1'000'000'000);
  const UtcMapping set = first.followed_by({Instant{101s}, UtcTime{2'000'200'000}});
  EXPECT_EQ(set.to_utc(Instant{101s}).nanoseconds, 2'000'200'000);
  const UtcMapping back = first.followed_by({Instant{101s}, UtcTime{5}});
  EXPECT_EQ(back.to_utc(Instant{101s}).nanoseconds, 5);
}

}  // namespace
}  // namespace fieldcast
