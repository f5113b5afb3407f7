#include "bridge/clock.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

TEST(UtcClock, NowIsTheWallClock) {
  const UtcClock clock;
  const auto wall = std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_NEAR(static_cast<double>(clock.at(steady_now()).nanoseconds - wall), 0.0, 1e9);
}

TEST(UtcClock, DistancesAreThoseOfTheMonotonicClock) {
  const UtcClock clock;
  const Instant now = steady_now();
  EXPECT_EQ(clock.at(now + std::chrono::milliseconds{250}).nanoseconds - clock.at(now).nanoseconds, 250'000'000);
}

TEST(UtcClock, NoInstantIsNoTime) {
  const UtcClock clock;
  EXPECT_EQ(clock.at(kLongAgo), UtcTime{});
  EXPECT_EQ(clock.at(kNever), UtcTime{});
}

}  // namespace
}  // namespace fieldcast
