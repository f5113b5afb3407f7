// How the offset of a bridge's clock is estimated from its messages.
#include "bridge/station/clock_offsets.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

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
