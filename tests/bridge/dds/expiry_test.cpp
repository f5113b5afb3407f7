#include <gtest/gtest.h>

#include "bridge/dds/receivers/request_receiver.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

const UtcMapping kNow{Instant{1000s}, {1'700'000'000'000'000'000}};

UtcTime written(Duration ago) { return {kNow.utc.nanoseconds - ago.count()}; }

TEST(CommandExpiry, IsTheSourceTimestampPlusTheLifespan) {
  EXPECT_EQ(expiry_of(written(0s), 5s, kNow), Instant{1005s});
  EXPECT_EQ(expiry_of(written(3s), 5s, kNow), Instant{1002s});
}

TEST(CommandExpiry, HasPassedForAnOldCommand) {
  EXPECT_LT(expiry_of(written(8s), 5s, kNow), kNow.instant);
}

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

TEST(CommandExpiry, ReasonNamesBothClocksAndTheirDifference) {
  EXPECT_EQ(clocks_text(written(10s), kNow),
            "written at 2023-11-14 22:13:10.000 UTC, received at 2023-11-14 22:13:20.000 UTC by "
            "this bridge's clock: the requester's clock is 10.0 s behind, or the request was late "
            "by that");
  EXPECT_EQ(clocks_text({0}, kNow), "");
  EXPECT_FALSE(clocks_text({1}, {Instant{}, {INT64_MAX}}).empty());
}

TEST(CommandAge, IsOlderThanTheReceiverThatWasNotThereYet) {
  const Instant listening = kNow.instant - 2s;
  EXPECT_EQ(written_before(listening, written(5s), kNow), Duration{3s});
  EXPECT_EQ(written_before(listening, written(2s), kNow), std::nullopt);
  EXPECT_EQ(written_before(listening, written(0s), kNow), std::nullopt);
}

TEST(CommandAge, IsTakenAsNoneWithoutATimestampOrFromAClockThatRunsAhead) {
  const Instant listening = kNow.instant;
  EXPECT_EQ(written_before(listening, {0}, kNow), std::nullopt);
  EXPECT_EQ(written_before(listening, {INT64_MIN}, kNow), std::nullopt);
  EXPECT_EQ(written_before(listening, written(-60s), kNow), std::nullopt);
}

// Compares both clocks at this time, so the wall clock at the start of the bridge is irrelevant.
TEST(CommandAge, DoesNotCareForStepsOfTheWallClock) {
  const Instant listening = kNow.instant - 60s;
  const UtcMapping stepped{kNow.instant, {kNow.utc.nanoseconds - Duration{1h}.count()}};
  const UtcTime just_now{stepped.utc.nanoseconds - 1'000'000};
  EXPECT_EQ(written_before(listening, just_now, stepped), std::nullopt);
}

}  // namespace
}  // namespace fieldcast
