#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "bridge/dds/receivers/request_receiver.hpp"
#include "bridge/dds/receivers/sample_load.hpp"
#include "bridge/station/clock_offsets.hpp"
#include "tests/bridge/dds/dds_support.hpp"

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

// How the offset of a bridge's clock is estimated from its messages.

// A bridge whose clock is behind this machine's by `ahead`.
struct Heard {
  std::optional<Duration> message(Duration on_the_way, const std::string& bus = "line") {
    now += 1s;
    const std::int64_t here = 1'000'000'000'000'000'000 + now.time_since_epoch().count();
    return offsets.add("b", bus, UtcTime{here - ahead.count() - on_the_way.count()}, UtcTime{here},
                       now);
  }
  ClockOffsets offsets;
  Duration ahead{};
  Instant now{1h};
};

TEST(ClockOffsets, AreTheSmallestDifference) {
  Heard heard;
  heard.ahead = 10s;
  EXPECT_EQ(heard.message(0s), std::nullopt);
  EXPECT_EQ(heard.message(300ms), 10300ms);
  EXPECT_EQ(heard.message(2ms), 10002ms);
  EXPECT_EQ(heard.message(800ms), 10002ms);
  heard.ahead = -10s;
  EXPECT_EQ(heard.message(1ms), -9999ms);
}

// A message that was kept for late readers is as old as it may be.
TEST(ClockOffsets, DoNotCountTheFirstMessageOfEachBus) {
  Heard heard;
  EXPECT_EQ(heard.message(1h), std::nullopt);
  EXPECT_EQ(heard.message(1h, "mill"), std::nullopt);
  EXPECT_EQ(heard.message(3ms), 3ms);
  EXPECT_EQ(heard.message(1h, "press"), 3ms);
}

TEST(ClockOffsets, FollowAStepOfTheClockWithinTwoWindows) {
  Heard heard;
  for (int i = 0; i < 60; ++i) (void)heard.message(1ms);
  heard.ahead = 1h;
  for (Duration passed{}; passed < 2 * ClockOffsets::kWindow; passed += 1s)
    (void)heard.message(1ms);
  EXPECT_EQ(heard.message(1ms), 1h + 1ms);
}

TEST(ClockOffsets, OfABridgeThatWasSilentAreNotRemembered) {
  Heard heard;
  for (int i = 0; i < 3; ++i) (void)heard.message(1ms);
  heard.now += 3 * ClockOffsets::kWindow;
  heard.ahead = 5s;
  EXPECT_EQ(heard.message(2ms), 5002ms);
}

TEST(ClockOffsets, IgnoreTimesThatCannotBe) {
  ClockOffsets offsets;
  const Instant now{1h};
  for (const std::int64_t written :
       {std::int64_t{0}, std::int64_t{-1}, std::numeric_limits<std::int64_t>::min()})
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(offsets.add("b", "line", UtcTime{written}, UtcTime{1}, now), std::nullopt);
  EXPECT_EQ(
      offsets.add("b", "line", UtcTime{std::numeric_limits<std::int64_t>::max()}, UtcTime{-2}, now),
      std::nullopt);
}

TEST(ClockOffsets, HaveALimitOfNamesAndForgetSilentOnes) {
  ClockOffsets offsets;
  Instant now{1h};
  const auto add = [&](const std::string& bridge) {
    return offsets.add(bridge, "line", UtcTime{1}, UtcTime{5}, now);
  };
  for (std::size_t i = 0; i < ClockOffsets::kMostBuses; ++i) (void)add("b" + std::to_string(i));
  (void)add("late");
  EXPECT_EQ(add("late"), std::nullopt);
  EXPECT_EQ(add("b0"), Duration{4});
  now += 2 * ClockOffsets::kWindow;
  (void)add("late");
  EXPECT_EQ(add("late"), Duration{4});
}

}  // namespace
}  // namespace fieldcast

namespace fieldcast::testing {
namespace {

BridgeSpec of_channels(std::size_t channels, Duration refresh) {
  BridgeSpec spec;
  spec.buses.push_back(bus_of("line", channels, [refresh](std::size_t) { return refresh; }));
  return spec;
}

TEST(SampleLoad, FollowsChannelsAndTheirRefreshes) {
  using namespace std::chrono_literals;
  EXPECT_EQ(sample_load(of_channels(1000, 1s)), 35714u);
  EXPECT_EQ(sample_load(of_channels(1000, 100ms)), 357142u);
  BridgeSpec on_demand = of_channels(1000, 1s);
  for (ChannelSpec& channel : on_demand.buses[0].devices[0].channels)
    channel.mode = Mode::kOnDemand;
  EXPECT_EQ(sample_load(on_demand), 0u);
}

TEST(SampleLoad, ABoundBelowItIsSaid) {
  using namespace std::chrono_literals;
  BridgeSpec spec = of_channels(10'000, 100ms);
  EXPECT_EQ(rate_remark(spec), std::nullopt);
  spec.dds.max_rate = 4'000'000;
  EXPECT_EQ(rate_remark(spec), std::nullopt);
  spec.dds.max_rate = 500'000;
  EXPECT_EQ(rate_remark(spec).value_or(""),
            "max-rate: 500 kB/s, and the samples for one station are at least 3571 kB/s: values "
            "come late, and some never; a larger max-rate, or longer refreshes");
}

}  // namespace
}  // namespace fieldcast::testing
