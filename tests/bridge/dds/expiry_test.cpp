#include <gtest/gtest.h>

#include "bridge/dds/command_receiver.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const UtcMapping kNow{Instant{1000s}, {1'700'000'000'000'000'000}};

UtcTime written(Duration ago) { return {kNow.utc.nanoseconds - ago.count()}; }

TEST(CommandExpiry, IsTheSourceTimestampPlusTheLifespan) {
  EXPECT_EQ(expiry_of(written(0s), 5s, kNow), Instant{1005s});
  EXPECT_EQ(expiry_of(written(3s), 5s, kNow), Instant{1002s});
}

TEST(CommandExpiry, HasPassedForAnOldCommand) { EXPECT_LT(expiry_of(written(8s), 5s, kNow), kNow.instant); }

TEST(CommandExpiry, IsNeverLongerThanTheLifespanForAClockThatRunsAhead) {
  EXPECT_EQ(expiry_of(written(-60s), 5s, kNow), Instant{1005s});
}

TEST(CommandExpiry, CountsFromNowWithoutATimestamp) {
  EXPECT_EQ(expiry_of({0}, 5s, kNow), Instant{1005s});
  EXPECT_EQ(expiry_of({INT64_MIN}, 5s, kNow), Instant{1005s});
}

TEST(CommandExpiry, DoesNotWrapForHugeNumbers) {
  EXPECT_GT(expiry_of(written(0s), Duration::max(), kNow), kNow.instant + 24h);
  EXPECT_LT(expiry_of({1}, 5s, kNow), kNow.instant);
}

}  // namespace
}  // namespace fieldcast
