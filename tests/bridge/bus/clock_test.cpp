#include "bridge/bus/clock.hpp"

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

}  // namespace
}  // namespace fieldcast
