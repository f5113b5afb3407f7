// What a plan takes for answer times, and for the pace of a line.
#include "core/schedule/planned_times.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "core/schedule/line_pace.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Remembers what it is told.
class Told final : public Scheduler {
 public:
  Decision next(Instant) override { return Rest{}; }
  void acquired(const Block&, Instant) override {}
  void failed(const Block&, Instant, Instant) override {}
  std::vector<PointIndex> refused(const Block&, Instant, Duration) override { return {}; }
  void suspend(DeviceIndex, Instant) override {}
  void set_answer_time(DeviceIndex device, AreaIndex area, Duration time) override {
    told.push_back({device, area, time});
  }
  void set_longest(DeviceIndex, AreaIndex, std::uint32_t) override {}
  Duration slack(Instant) override { return {}; }
  void set_point(PointIndex, Duration, Mode, Instant) override {}
  std::unique_ptr<PlanDraft> draft() override { return nullptr; }
  void adopt(PlanDraft&, Instant) override {}
  [[nodiscard]] double planned_load() const override { return 0; }
  [[nodiscard]] double stretch() const override { return 1; }

  struct Call {
    DeviceIndex device;
    AreaIndex area;
    Duration time;
    friend bool operator==(const Call&, const Call&) = default;
  };
  std::vector<Call> told;
};

constexpr std::array<std::size_t, 2> kAreas{2, 1};  // two devices

TEST(PlannedTimes, MicrosecondsMakeNoOtherPlan) {
  EXPECT_EQ(PlannedTimes::rounded(-1ms), 0ms);
  EXPECT_EQ(PlannedTimes::rounded(0ms), 0ms);
  for (const Duration time : {Duration{1990us}, Duration{2ms}, Duration{2005us}})
    EXPECT_EQ(PlannedTimes::rounded(time), 2ms);
  EXPECT_EQ(PlannedTimes::rounded(2100us), 2250us) << "rather too long than too short";
  EXPECT_EQ(PlannedTimes::rounded(20ms), 20ms);
  EXPECT_EQ(PlannedTimes::rounded(100ms), 100ms);
}

TEST(PlannedTimes, WhatHasNotAnsweredIsTakenToBeLikeWhatHas) {
  PlannedTimes times(kAreas, 5ms);
  Told scheduler;
  times.answered(0, 1, 2005us, scheduler);
  EXPECT_EQ(scheduler.told, (std::vector<Told::Call>{{0, 1, 2ms}, {0, 0, 2ms}, {1, 0, 2ms}}));
  scheduler.told.clear();
  times.answered(1, 0, 9ms, scheduler);
  EXPECT_EQ(scheduler.told, (std::vector<Told::Call>{{1, 0, 9ms}})) << "the others are known";
}

TEST(PlannedTimes, SmallChangesAreNotTold) {
  PlannedTimes times(kAreas, 5ms);
  Told scheduler;
  for (int i = 0; i < 200; ++i) times.answered(0, 0, i % 2 == 0 ? 4700us : 5200us, scheduler);
  EXPECT_TRUE(scheduler.told.empty());
}

TEST(LinePace, IsThatOfTheSlowestOfTheLastReads) {
  LinePace pace;
  EXPECT_EQ(pace.of(100), 100);
  for (int i = 0; i < 32; ++i) pace.read(20, 100);
  EXPECT_EQ(pace.of(100), 20);
  pace.read(80, 100);
  EXPECT_EQ(pace.of(100), 80) << "a slow one counts at once";
  pace.read(500, 100);
  EXPECT_EQ(pace.of(100), 100) << "a retry is no pace of the line";
  for (int i = 0; i < 32; ++i) pace.read(95, 100);
  EXPECT_EQ(pace.of(100), 100) << "nor is a small difference";
}

}  // namespace
}  // namespace fieldcast
