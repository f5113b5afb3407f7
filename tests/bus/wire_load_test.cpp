#include <gtest/gtest.h>

#include "core/bus/wire/wire.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(WireLoad, SharesAreOfTheTimeSinceTheReportBefore) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  load.ended(200ms, true);
  load.ended(300ms, false);
  const auto shares = load.report(0ms, false, Instant{1s});
  EXPECT_DOUBLE_EQ(shares.busy, 0.5);
  EXPECT_DOUBLE_EQ(shares.reading, 0.2);
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{2s}).busy, 0);
}

TEST(WireLoad, TheExchangeOnTheWireCountsAsFarAsItHasCome) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  EXPECT_DOUBLE_EQ(load.report(400ms, true, Instant{1s}).busy, 0.4);
  load.ended(600ms, true);
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{2s}).busy, 0.2);
}

TEST(WireLoad, ReadsAreSharedOverTenSeconds) {
  WireLoad load;
  for (int second = 0; second < 30; ++second) {
    if (second < 15) load.ended(500ms, true);
    (void)load.report(0ms, false, Instant{std::chrono::seconds{second}});
  }
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{30s}).reading, 0);
  load.ended(1s, true);
  EXPECT_NEAR(load.report(0ms, false, Instant{31s}).reading, 0.1, 0.01);
}

TEST(WireLoad, AReportBetweenTheRegularOnesSetsNoMark) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  load.ended(500ms, false);
  (void)load.report(0ms, false, Instant{500ms});
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{1s}).busy, 0.5);
}

}  // namespace
}  // namespace fieldcast
