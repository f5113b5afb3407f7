#include "tools/forward/clock_steps.hpp"

#include <gtest/gtest.h>

namespace fieldcast::forward {
namespace {

using namespace std::chrono_literals;

UtcMapping clock_reading(Duration since_start, std::int64_t utc_seconds) {
  return {.instant = Instant(since_start), .utc = {utc_seconds * 1'000'000'000}};
}

TEST(ClockSteps, AStepIsReportedOnceWithItsSign) {
  ClockSteps clock;
  EXPECT_EQ(clock.on_reading(clock_reading(10s, 1'000)), 0s) << "the first reading";
  EXPECT_EQ(clock.on_reading(clock_reading(11s, 1'001)), 0s);
  EXPECT_EQ(clock.on_reading(clock_reading(12s, 4'602)), 3600s);
  EXPECT_EQ(clock.on_reading(clock_reading(13s, 4'603)), 0s);
  EXPECT_EQ(clock.on_reading(clock_reading(14s, 1'004)), -3600s);
}

TEST(ClockSteps, ALongPauseBetweenReadingsAndASlewAreNoStep) {
  ClockSteps clock;
  (void)clock.on_reading(clock_reading(10s, 1'000));
  EXPECT_EQ(clock.on_reading(clock_reading(3610s, 4'600)), 0s);
  EXPECT_EQ(clock.on_reading(clock_reading(3611s, 4'602)), 0s) << "a second ahead";
}

}  // namespace
}  // namespace fieldcast::forward
