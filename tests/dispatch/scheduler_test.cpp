#include "core/dispatch/scheduler.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/plan/layout/partition.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualWire;

using test::kFakeProtocol;

void add_points(ScheduleInput& input, DeviceIndex device, std::uint32_t first, std::uint32_t count,
                std::uint32_t step, Duration refresh, Mode mode = Mode::kScheduled) {
  for (std::uint32_t i = 0; i < count; ++i) {
    Point point;
    point.device = device;
    point.range = Range{test::kRegisters, first + i * step, 1};
    point.refresh = refresh;
    point.mode = mode;
    input.points.push_back(point);
  }
}

ScheduleInput plant(unsigned devices, std::uint32_t baud = 19200) {
  ScheduleInput input = test::input_of({}, kFakeProtocol, baud);
  DeviceTiming device;
  device.protocol = &kFakeProtocol;
  device.response_time = 4ms;
  input.devices.assign(devices, device);
  return input;
}

TEST(Scheduler, NothingToReadIsRestForEver) {
  const ScheduleInput input = plant(1);
  EXPECT_EQ(std::get<Rest>(make_scheduler(input)->next(Instant{5s})).until, kNever);
}

TEST(Scheduler, OnDemandPointsAreNeverRead) {
  ScheduleInput input = plant(1);
  add_points(input, 0, 0, 10, 1, 1s, Mode::kOnDemand);
  EXPECT_EQ(std::get<Rest>(make_scheduler(input)->next(Instant{5s})).until, kNever);
}

// The rest after a response is a large part of these reads, but not of their refresh.
TEST(Scheduler, FewLongReadsWithLongRestsAreKeptOnACrowdedWire) {
  for (const Duration pause : {Duration{0}, Duration{200ms}}) {
    ScheduleInput input = plant(1, 300);
    input.devices[0].pause = pause;
    add_points(input, 0, 1, 2, 500, 1s);
    const double alone = make_scheduler(input)->planned_load();
    for (const double load : {0.6, 0.75, 0.9}) {
      for (Point& point : input.points) point.refresh = from_seconds(alone / load);
      const auto scheduler = make_scheduler(input);
      VirtualWire wire(input, *scheduler);
      wire.run(10min);
      EXPECT_EQ(wire.missed(), 0u) << load;
      EXPECT_LT(wire.load(), 1.15 * load) << "reads that nobody needed";
    }
  }
}

TEST(Scheduler, EveryPointIsReadImmediatelyWhenTheWireIsIdle) {
  ScheduleInput input = plant(3);
  for (DeviceIndex device = 0; device < 3; ++device) add_points(input, device, 100, 20, 3, 60s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(2s);
  for (PointIndex point = 0; point < input.points.size(); ++point)
    EXPECT_EQ(wire.seen(point).count, 1u) << point;
}

TEST(Scheduler, ScheduledPointsAreReadInTimeAndThenTheWireRests) {
  ScheduleInput input = plant(2);
  add_points(input, 0, 0, 5, 2, 500ms);
  add_points(input, 1, 0, 5, 2, 2s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(60s);
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_LT(wire.load(), scheduler->planned_load() * 1.15);
  EXPECT_GT(wire.load(), scheduler->planned_load() * 0.85);
}

TEST(Scheduler, IntensiveWireNeverRests) {
  ScheduleInput input = plant(2);
  add_points(input, 0, 0, 5, 2, 5s, Mode::kIntensive);
  add_points(input, 1, 0, 5, 2, 5s, Mode::kIntensive);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(10s);
  EXPECT_GT(wire.load(), 0.999);
}

// 300 scattered registers at 115200 baud: as fast as a loop over the optimal partition.
TEST(Scheduler, IntensivePointsOfOneRefreshConvergeToTheOptimalPartition) {
  ScheduleInput input = test::input_of(test::random_map(7, 300), kFakeProtocol, 115200, 2ms);
  Duration loop{};
  for (DeviceIndex device = 0; device < 3; ++device) {
    std::vector<Wanted> wanted;
    for (Point& point : input.points) {
      point.refresh = 1s;
      point.mode = Mode::kIntensive;
      if (point.device == device) wanted.push_back({point.range.first, point.range.end()});
    }
    const ReadCost cost(input.devices[device], test::kRegisters, input.line, input.silence, 65000);
    loop += cost_of(wanted, optimal_partition(wanted, cost), cost);
  }
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(10s);
  wire.forget_gaps();
  wire.run(30s);
  std::uint64_t refreshes = 0;
  Duration longest{}, shortest = Duration::max();
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    refreshes += wire.seen(point).count;
    longest = std::max(longest, wire.seen(point).longest);
    shortest = std::min(shortest, wire.seen(point).shortest);
  }
  EXPECT_GE(static_cast<double>(refreshes), 0.99 * 300 * to_seconds(30s) / to_seconds(loop));
  EXPECT_LE(to_seconds(longest), 1.3 * to_seconds(shortest));
}

TEST(Scheduler, NoGapIsLongerThanThePlanSays) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const test::Map map = test::random_map(seed, 150);
    const ScheduleInput input =
        test::input_of(map, kFakeProtocol, 19200, 5ms, test::least_load(map, 19200, 5ms) / 0.5);
    const auto scheduler = make_scheduler(input);
    VirtualWire wire(input, *scheduler);
    wire.run(2 * scheduler->plan().hyperperiod());
    wire.forget_gaps();
    wire.run(5min);
    const ReadPlan& plan = scheduler->plan();
    for (OrderIndex at = 0; at < plan.points.size(); ++at)
      EXPECT_LE(wire.seen(plan.order[at]).longest, *plan.points[at].worst_gap) << plan.order[at];
  }
}

TEST(Scheduler, SlowPointsAreReadTogetherWithFastNeighbours) {
  ScheduleInput input = plant(1);
  add_points(input, 0, 10, 1, 1, 200ms);
  add_points(input, 0, 11, 4, 1, 5s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(2s);
  wire.forget_gaps();
  wire.run(60s);
  EXPECT_EQ(wire.missed(), 0u);
  EXPECT_LE(wire.blocks(), wire.seen(0).count);  // each read includes the fast point
  EXPECT_LE(wire.seen(1).count, 16u);            // the slow points are not in all reads
}

TEST(Scheduler, SuspendedDevicesAreNotTouchedAndTheOthersKeepTheirRefresh) {
  ScheduleInput input = plant(3);
  for (DeviceIndex device = 0; device < 3; ++device) add_points(input, device, 0, 10, 2, 500ms);
  const auto scheduler = make_scheduler(input);
  scheduler->suspend(1, Instant{1030s});
  VirtualWire wire(input, *scheduler);
  wire.check = [&](const Block& block) {
    EXPECT_TRUE(block.device != 1 || wire.now() >= Instant{1030s});
  };
  wire.run(30s);
  EXPECT_EQ(wire.seen(10).count, 0u);
  wire.forget_gaps();
  wire.run(30s);
  EXPECT_GE(wire.seen(10).count, 59u);
  for (PointIndex point = 0; point < 30; ++point) {
    if (point / 10 != 1) { EXPECT_EQ(wire.seen(point).missed, 0u) << point; }
  }
}

TEST(Scheduler, SuspensionCanBeLifted) {
  ScheduleInput input = plant(1);
  add_points(input, 0, 0, 3, 1, 500ms);
  const auto scheduler = make_scheduler(input);
  scheduler->suspend(0, kNever);
  EXPECT_EQ(std::get<Rest>(scheduler->next(Instant{1s})).until, kNever);
  scheduler->suspend(0, Instant{2s});
  EXPECT_EQ(std::get<Rest>(scheduler->next(Instant{1s})).until, Instant{2s});
  EXPECT_EQ(std::get<Block>(scheduler->next(Instant{2s})).points.size(), 3u);
}

TEST(Scheduler, SilentBlocksDoNotStarveOthers) {
  ScheduleInput input = plant(2);
  add_points(input, 0, 0, 10, 2, 1s);
  add_points(input, 1, 0, 10, 2, 1s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.device = [](const Block& block) {
    return block.device == 0 ? test::Answer::kSilent : test::Answer::kGood;
  };
  wire.run(60s);
  EXPECT_EQ(wire.seen(0).count, 0u);
  for (PointIndex point = 10; point < 20; ++point) EXPECT_EQ(wire.seen(point).missed, 0u) << point;
}

TEST(Scheduler, FailedBlockIsNotRetriedBeforeItsTime) {
  ScheduleInput input = plant(1);
  add_points(input, 0, 0, 3, 1, 500ms);
  const auto scheduler = make_scheduler(input);
  const Block block = std::get<Block>(scheduler->next(Instant{1s}));
  scheduler->failed(block, Instant{1200ms}, Instant{1500ms});
  EXPECT_EQ(std::get<Rest>(scheduler->next(Instant{1200ms})).until, Instant{1500ms});
  EXPECT_EQ(std::get<Block>(scheduler->next(Instant{1500ms})).points, block.points);
}

TEST(Scheduler, ShorterRefreshTakesEffectImmediately) {
  ScheduleInput input = plant(1);
  add_points(input, 0, 0, 1, 1, 10s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(5s);
  Point wanted = input.points[0];
  wanted.refresh = 100ms;
  scheduler->set_point(0, wanted, wire.now());
  wire.forget_gaps();
  wire.run(10s);
  EXPECT_GE(wire.seen(0).count, 100u);
  wanted.mode = Mode::kOnDemand;
  scheduler->set_point(0, wanted, wire.now());
  wire.forget_gaps();
  wire.run(30s);
  EXPECT_EQ(wire.seen(0).count, 0u);
}

TEST(Scheduler, BlocksStayWithinTheLimitsOfTheDevice) {
  ScheduleInput input = plant(1);
  input.devices[0].max_block = 12;
  input.devices[0].max_gap = 3;
  add_points(input, 0, 0, 40, 3, 1s);
  add_points(input, 0, 300, 20, 6, 1s);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.check = [&](const Block& block) {
    ASSERT_EQ(block.ranges.size(), 1u);
    EXPECT_LE(block.ranges[0].count, 12u);
    if (block.ranges[0].first >= 300) { EXPECT_EQ(block.points.size(), 1u); }
  };
  wire.run(20s);
}

TEST(Scheduler, OverloadStretchesEveryRefreshAndStarvesNobody) {
  const test::Map map = test::random_map(3, 300);
  ScheduleInput input = test::input_of(map, kFakeProtocol, 9600);
  const auto scheduler = make_scheduler(input);
  EXPECT_GT(scheduler->planned_load(), 2.0);
  EXPECT_GT(scheduler->stretch(), 2.0);
  VirtualWire wire(input, *scheduler);
  wire.run(120s);
  wire.forget_gaps();
  wire.run(300s);
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    EXPECT_LT(to_seconds(wire.seen(point).longest),
              1.6 * scheduler->stretch() * to_seconds(input.points[point].refresh))
        << point;
    EXPECT_GT(wire.seen(point).count, 0u) << point;
  }
}

TEST(Scheduler, AbsurdRefreshesNeitherHangNorStarve) {
  ScheduleInput input = plant(2);
  add_points(input, 0, 0, 3, 1, Duration{0});
  add_points(input, 0, 10, 3, 1, 1ns);
  add_points(input, 1, 0, 3, 1, Duration::max());
  add_points(input, 1, 500, 3, 1, 1s);
  input.points.back().priority = 100;
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.run(20s);
  Point wanted = input.points[9];
  wanted.refresh = Duration{-5};
  scheduler->set_point(9, wanted, wire.now());
  wanted.refresh = Duration::max();
  wanted.mode = Mode::kIntensive;
  scheduler->set_point(10, wanted, wire.now());
  wire.run(20s);
  for (const PointIndex point : {0u, 3u, 9u, 11u}) EXPECT_GT(wire.seen(point).count, 1u) << point;
}

}  // namespace
}  // namespace fieldcast
