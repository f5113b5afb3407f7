#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/schedule/prediction.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualWire;

using test::kFakeProtocol;

// Units, areas, widths, limits and response times at random, with about half of the load.
ScheduleInput random_input(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  constexpr std::array kRefreshes{100, 200, 250, 500, 700, 1000, 2000, 3000, 5000, 10'000};
  ScheduleInput input = test::input_of({}, kFakeProtocol, below(2) ? 19200 : 38400);
  const auto units = static_cast<unsigned>(1 + below(5));
  for (unsigned unit = 0; unit < units; ++unit) {
    DeviceTiming device;
    device.protocol = &kFakeProtocol;
    device.response_time = Duration{static_cast<std::int64_t>(below(12'000'000))};
    if (below(4) == 0) device.pause = 3ms;
    if (below(3) == 0) device.max_block = static_cast<std::uint16_t>(8 + below(40));
    if (below(3) == 0) device.max_gap = static_cast<std::uint16_t>(below(8));
    input.devices.push_back(device);
    for (std::uint32_t first = static_cast<std::uint32_t>(below(20));
         input.points.size() < 30 * (unit + 1);) {
      Point point;
      point.device = static_cast<DeviceIndex>(unit);
      const AreaIndex area = static_cast<AreaIndex>(below(8) == 0 ? 1 + below(3) : 0);
      point.range = {area, area == test::kWindow ? first % 60 : first % 900,
                     static_cast<std::uint32_t>(1 + below(4))};
      point.refresh = std::chrono::milliseconds{kRefreshes[below(kRefreshes.size())]};
      point.priority = static_cast<int>(below(3)) - 1;
      input.points.push_back(point);
      first += static_cast<std::uint32_t>(below(7) == 0 ? 40 : below(5));
    }
  }
  const double wanted = make_scheduler(input)->planned_load();
  for (Point& point : input.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * wanted / 0.55);
  return input;
}

class RandomBus : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomBus, WhatIsPredictedFeasibleMissesNothingAndBlocksAreSound) {
  const ScheduleInput input = random_input(GetParam());
  const Prediction prediction = predict(input, {.remedies = false});
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.check = [&](const Block& block) {
    const DeviceTiming& device = input.devices[block.device];
    ASSERT_EQ(block.ranges.size(), 1u);
    ASSERT_FALSE(block.points.empty());
    const Range& range = block.ranges.front();
    const Area& area = kFakeProtocol.areas()[range.area];
    EXPECT_TRUE(kFakeProtocol.size(ReadRequest{block.ranges}));
    EXPECT_EQ(range.first % area.alignment, 0u);
    if (device.max_block != 0 && block.points.size() > 1 && !area.window && area.alignment == 1) {
      EXPECT_LE(range.count, device.max_block);
    }
    const ExchangeSize size = *kFakeProtocol.size(ReadRequest{block.ranges});
    EXPECT_EQ(block.cost, wire_time(size, input.line, input.silence, device));
    std::set<PointIndex> unique(block.points.begin(), block.points.end());
    EXPECT_EQ(unique.size(), block.points.size());
    for (const PointIndex point : block.points) {
      const Point& wanted = input.points[point];
      EXPECT_EQ(wanted.device, block.device);
      EXPECT_EQ(wanted.range.area, range.area);
      EXPECT_TRUE(wanted.range.first >= range.first && wanted.range.end() <= range.end());
    }
  };
  wire.run(prediction.horizon);
  if (prediction.feasible) {
    EXPECT_EQ(wire.missed(), 0u);
    EXPECT_EQ(wire.overdue(), 0u);
    EXPECT_NEAR(wire.load(), prediction.load, 0.05 * prediction.load);
  }
  for (PointIndex point = 0; point < input.points.size(); ++point)
    EXPECT_GT(wire.seen(point).count, 0u) << point;
}

TEST_P(RandomBus, HalfTheLoadIsFeasible) {
  EXPECT_TRUE(predict(random_input(GetParam()), {.remedies = false}).feasible);
}

// Devices stop responding, recover and refuse. No point starves.
TEST_P(RandomBus, FaultsOfSomeStarveNobody) {
  const ScheduleInput input = random_input(GetParam());
  std::mt19937_64 random(GetParam() + 1000);
  const auto scheduler = make_scheduler(input);
  VirtualWire wire(input, *scheduler);
  wire.timeout = 30ms;
  wire.retry_after = 100ms;
  wire.forget = 20s;
  std::vector<Instant> suspended(input.devices.size(), kLongAgo);
  wire.check = [&](const Block& block) { EXPECT_GE(wire.now(), suspended[block.device]); };
  wire.device = [&](const Block& block) {
    if (block.device == 0 && random() % 4 == 0) return test::Answer::kSilent;
    if (block.ranges[0].first <= 20 && 20 < block.ranges[0].end() && block.ranges[0].area == 0)
      return test::Answer::kRefused;
    return test::Answer::kGood;
  };
  for (int step = 0; step < 60; ++step) {
    wire.run(2s);
    const auto device = static_cast<DeviceIndex>(random() % input.devices.size());
    if (step % 5 == 0) scheduler->suspend(device, suspended[device] = wire.now() + 700ms);
  }
  Duration slowest{};
  for (const Point& point : input.points) slowest = std::max(slowest, point.refresh);
  wire.run(2 * slowest + 60s);
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    const Range& range = input.points[point].range;
    if (range.area == 0 && range.first <= 20 && 20 < range.end()) continue;
    EXPECT_GT(wire.seen(point).count, 1u) << point;
    EXPECT_LT(to_seconds(wire.now() - wire.seen(point).last),
              4 * to_seconds(input.points[point].refresh) + 3)
        << point;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBus, ::testing::Range<std::uint64_t>(1, 41));

TEST(Overload, LowPriorityGivesWayFirst) {
  ScheduleInput input = test::input_of(test::random_map(4, 90), kFakeProtocol);
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    input.points[point].priority = input.points[point].device == 0 ? 10 : 0;
    input.points[point].refresh = 250ms;
  }
  const auto scheduler = make_scheduler(input);
  ASSERT_GT(scheduler->planned_load(), 1.0);
  EXPECT_GT(scheduler->stretch(), 1.0);
  VirtualWire wire(input, *scheduler);
  wire.run(30s);
  wire.forget_gaps();
  wire.run(120s);
  Duration high{}, low = Duration::max();
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    const bool favoured = input.points[point].device == 0;
    if (favoured) high = std::max(high, wire.seen(point).longest);
    if (!favoured) low = std::min(low, wire.seen(point).longest);
    EXPECT_GT(wire.seen(point).count, 10u) << point;
  }
  EXPECT_LE(high,
            300ms);  // at most a fifth over its refresh, while the others more than double theirs
  EXPECT_GT(low, 500ms);
}

TEST(Overload, OfOnePriorityEachGivesWayByItsElasticity) {
  ScheduleInput input = test::input_of(test::random_map(4, 90), kFakeProtocol);
  constexpr std::array kElasticities{0.2, 1.0, 4.0};  // by device
  for (Point& point : input.points) {
    point.refresh = 350ms;
    point.elasticity = kElasticities[point.device];
  }
  const auto scheduler = make_scheduler(input);
  ASSERT_GT(scheduler->planned_load(), 1.0);
  VirtualWire wire(input, *scheduler);
  wire.run(30s);
  wire.forget_gaps();
  wire.run(120s);
  std::array<Duration, 3> longest{};
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    Duration& of_device = longest[input.points[point].device];
    of_device = std::max(of_device, wire.seen(point).longest);
  }
  EXPECT_LT(longest[0], longest[1]);
  EXPECT_LT(1.5 * longest[1], longest[2]);
  EXPECT_NEAR(to_seconds(longest[2]), 0.35 * scheduler->stretch(),
              0.25 * 0.35 * scheduler->stretch());
}

// Refreshes of many times the capacity: every point must still be read within a bound.
class RandomOverload : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomOverload, StarvesNobody) {
  ScheduleInput input = random_input(GetParam());
  std::mt19937_64 random(GetParam() + 2000);
  const double overload = 2.0 + static_cast<double>(random() % 8);
  for (Point& point : input.points) {
    point.refresh = from_seconds(to_seconds(point.refresh) * 0.55 / overload);
    point.priority = static_cast<int>(random() % 201) - 100;
    point.elasticity = 0.1 * static_cast<double>(1 + random() % 100);
    if (random() % 10 == 0) point.mode = Mode::kIntensive;
  }
  for (const Planner planner : {Planner::kCyclic, Planner::kDynamicBlocks}) {
    const auto scheduler = make_scheduler(input, planner);
    ASSERT_GT(scheduler->planned_load(), 1.0);
    EXPECT_GT(scheduler->stretch(), 1.0);
    VirtualWire wire(input, *scheduler);
    wire.run(120s);
    for (PointIndex point = 0; point < input.points.size(); ++point) {
      const double allowed = 2 * to_seconds(input.points[point].refresh) * scheduler->stretch() + 5;
      EXPECT_LT(to_seconds(wire.now() - wire.seen(point).last), allowed)
          << to_text(planner) << ", point " << point;
      EXPECT_LT(to_seconds(wire.seen(point).longest), allowed)
          << to_text(planner) << ", point " << point;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomOverload, ::testing::Range<std::uint64_t>(1, 13));

TEST(Overload, WireThatIsSlowerThanPlannedStretchesToo) {
  ScheduleInput input = test::input_of(test::random_map(4, 90), kFakeProtocol, 115200);
  const double planned = make_scheduler(input)->planned_load();
  for (Point& point : input.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * planned / 0.5);
  const auto scheduler = make_scheduler(input);
  Instant now{1s};
  while (now < Instant{300s}) {
    const Decision decision = scheduler->next(now);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = rest->until;
    } else {
      const Block& block = std::get<Block>(decision);
      now += 3 * block.cost;
      scheduler->acquired(block, now - input.silence);
      replan(*scheduler, now);
    }
  }
  EXPECT_GT(scheduler->stretch(), 1.2);
  EXPECT_LT(scheduler->stretch(), 4.0);
}

TEST(Overload, NewResponseTimeChangesThePlan) {
  ScheduleInput input = test::input_of(test::random_map(4, 90), kFakeProtocol);
  const double planned = make_scheduler(input)->planned_load();
  for (Point& point : input.points)
    point.refresh = from_seconds(to_seconds(point.refresh) * planned / 0.7);
  const auto scheduler = make_scheduler(input);
  EXPECT_EQ(scheduler->stretch(), 1.0);
  VirtualWire wire(input, *scheduler);
  wire.run(5s);
  for (DeviceIndex device = 0; device < input.devices.size(); ++device)
    scheduler->set_response_time(device, test::kRegisters, 60ms);
  wire.run(1s);
  EXPECT_GT(scheduler->planned_load(), 1.0);
  EXPECT_GT(scheduler->stretch(), 1.1);
  for (DeviceIndex device = 0; device < input.devices.size(); ++device)
    scheduler->set_response_time(device, test::kRegisters, 2ms);
  wire.run(1s);
  EXPECT_EQ(scheduler->stretch(), 1.0);
}

}  // namespace
}  // namespace fieldcast
