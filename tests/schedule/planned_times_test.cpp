#include "core/schedule/planned_times.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Changes = std::vector<PlannedTime>;

constexpr std::array<std::size_t, 1> kOneArea{1};
constexpr std::array<std::size_t, 2> kTwoDevices{2, 1};

TEST(PlannedTimes, StepsAreAQuarterOfAMillisecondUpTo8MsAndDoubleFromThere) {
  // A time is rounded down only if it is at most a quarter of a step above.
  EXPECT_EQ(PlannedTimes::rounded(62us), 0ms);
  EXPECT_EQ(PlannedTimes::rounded(63us), 250us);
  EXPECT_EQ(PlannedTimes::rounded(7812us), 7750us);
  EXPECT_EQ(PlannedTimes::rounded(7813us), 8ms);
  EXPECT_EQ(PlannedTimes::rounded(8124us), 8ms);
  EXPECT_EQ(PlannedTimes::rounded(8125us), 8500us);
  EXPECT_EQ(PlannedTimes::rounded(15999us), 16ms);
  EXPECT_EQ(PlannedTimes::rounded(16249us), 16ms);
  EXPECT_EQ(PlannedTimes::rounded(16250us), 17ms);
  EXPECT_EQ(PlannedTimes::rounded(32499us), 32ms);
  EXPECT_EQ(PlannedTimes::rounded(32500us), 34ms);
}

TEST(PlannedTimes, ALongerTimeIsReportedFromASixteenthOn) {
  const auto after = [](Duration measured) {
    PlannedTimes times(kOneArea, 32ms);
    return times.responded(0, 0, measured);
  };
  EXPECT_EQ(after(34ms), Changes{}) << "a sixteenth";
  EXPECT_EQ(after(34ms + 1us), (Changes{{0, 0, 34ms}}));
  EXPECT_EQ(after(28ms + 1us), Changes{}) << "less than an eighth shorter";
  EXPECT_EQ(after(28ms), (Changes{{0, 0, 28ms}}));
}

TEST(PlannedTimes, ShortTimesDifferByAStepOrTwo) {
  const auto after = [](Duration measured) {
    PlannedTimes times(kOneArea, 1ms);
    return times.responded(0, 0, measured);
  };
  EXPECT_EQ(after(1250us), Changes{});
  EXPECT_EQ(after(1251us), (Changes{{0, 0, 1250us}}));
  EXPECT_EQ(after(501us), Changes{});
  EXPECT_EQ(after(500us), (Changes{{0, 0, 500us}}));
  EXPECT_EQ(after(-5ms), (Changes{{0, 0, 0ms}}));
}

TEST(PlannedTimes, FollowTheMeanOf64Responses) {
  PlannedTimes times(kOneArea, 2ms);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(times.responded(0, 0, 2ms), Changes{});
  // Each response counts a 64th: 2 ms + 40 ms / 64 are 2.625 ms.
  EXPECT_EQ(times.responded(0, 0, 42ms), (Changes{{0, 0, 2750us}}));
  // The mean of two responses is in the middle.
  PlannedTimes few(kOneArea, 2ms);
  (void)few.responded(0, 0, 2ms);
  EXPECT_EQ(few.responded(0, 0, 6ms), (Changes{{0, 0, 4ms}}));
}

TEST(PlannedTimes, AnUnknownAreaTakesTheSlowestOfItsDeviceOrOfAll) {
  PlannedTimes times(kTwoDevices, 5ms);
  (void)times.responded(1, 0, 20ms);
  // The second area of device 0 follows the first one of its own device, not device 1.
  EXPECT_EQ(times.responded(0, 0, 10ms), (Changes{{0, 0, 10ms}, {0, 1, 10ms}}));
  EXPECT_EQ(times.responded(0, 1, 30ms), (Changes{{0, 1, 30ms}}));
}

TEST(PlannedTimes, ADeviceThatIsForgottenCountsAsUnknown) {
  PlannedTimes times(kTwoDevices, 5ms);
  (void)times.responded(0, 0, 10ms);
  (void)times.responded(1, 0, 20ms);
  times.forget(1);
  // The first response after it replaces the mean, and the plan of the areas without any.
  EXPECT_EQ(times.responded(1, 0, 40ms), (Changes{{1, 0, 40ms}}));
  times.forget(1);
  (void)times.responded(0, 1, 60ms);
  EXPECT_EQ(times.responded(1, 0, 60ms), Changes{}) << "it follows device 0 already";
}

// A scheduler of one point; its plan shows the response time.
struct Planned {
  ScheduleInput input = test::input_of({{1, 0, 1.0}}, test::kFakeProtocol, 19200, 8ms);
  std::unique_ptr<Scheduler> scheduler = make_scheduler(input);
  [[nodiscard]] Duration cost() { return std::get<Block>(scheduler->next(Instant{1s})).cost; }
};

TEST(PlannedTimes, TheSchedulerGetsTheTimeWithoutTheSavedSilence) {
  Planned planned;
  const std::array<std::size_t, 1> areas{test::kFakeProtocol.areas().size()};
  PlannedTimes times(areas, 8ms);
  times.responded(0, test::kRegisters, 16ms, *planned.scheduler);
  const Duration whole = planned.cost();
  times.save(3ms, *planned.scheduler);
  EXPECT_EQ(planned.cost(), whole - 3ms);
  times.responded(0, test::kRegisters, 160ms, *planned.scheduler);
  EXPECT_EQ(planned.cost(), whole - 3ms + 72ms) << "the mean of 16 and 160 ms is 88 ms";
  times.save(0ms, *planned.scheduler);
  EXPECT_EQ(planned.cost(), whole + 72ms);
}

}  // namespace
}  // namespace fieldcast
