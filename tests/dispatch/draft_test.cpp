#include <gtest/gtest.h>

#include <random>

#include "core/dispatch/plan_draft.hpp"
#include "tests/dispatch/virtual_wire.hpp"
#include "tests/plan/fake_protocol.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kFakeProtocol;

ScheduleInput plant_of(std::uint64_t seed) {
  const test::Map map = test::random_map(seed, 120);
  return test::input_of(map, kFakeProtocol, 19200, 5ms, test::least_load(map, 19200, 5ms) / 0.3);
}

TEST(Draft, ThereIsNoneWithoutAChangeAndOneAtATime) {
  const ScheduleInput input = plant_of(1);
  const auto scheduler = make_scheduler(input);
  EXPECT_EQ(scheduler->draft(), nullptr);
  scheduler->set_response_time(0, test::kRegisters, 9ms);
  const auto draft = scheduler->draft();
  ASSERT_NE(draft, nullptr);
  scheduler->set_response_time(0, test::kRegisters, 12ms);
  EXPECT_EQ(scheduler->draft(), nullptr) << "one is out";
  draft->make();
  scheduler->adopt(*draft, Instant{1s});
  EXPECT_NE(scheduler->draft(), nullptr) << "of what changed meanwhile";
}

TEST(Draft, AnAreaThatIsNotReadIsNoChange) {
  const ScheduleInput input = plant_of(1);
  const auto scheduler = make_scheduler(input);
  scheduler->set_response_time(0, test::kWindow, 9ms);
  scheduler->set_longest(0, test::kWindow, 4);
  EXPECT_EQ(scheduler->draft(), nullptr);
  scheduler->set_longest(0, test::kRegisters, 4);
  EXPECT_NE(scheduler->draft(), nullptr);
}

TEST(Draft, ItsPlanIsTakenAsItIs) {
  const ScheduleInput input = plant_of(2);
  const auto scheduler = make_scheduler(input);
  test::VirtualWire wire(input, *scheduler);
  wire.run(3s);
  const ReadPlan before = scheduler->plan();
  for (DeviceIndex device = 0; device < input.devices.size(); ++device)
    scheduler->set_response_time(device, test::kRegisters, 40ms);
  const auto draft = scheduler->draft();
  ASSERT_NE(draft, nullptr);
  draft->make();
  ASSERT_TRUE(draft->result().plan) << "forty milliseconds are another plan";
  const ReadPlan made = *draft->result().plan;
  EXPECT_NE(made, before);
  scheduler->adopt(*draft, wire.now());
  EXPECT_EQ(scheduler->plan(), made);
}

class ChangingBus : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ChangingBus, KeepsWhatIsAskedForWhileAPlanIsMade) {
  std::mt19937_64 random(GetParam());
  ScheduleInput input = plant_of(GetParam());
  const auto scheduler = make_scheduler(input);
  test::VirtualWire wire(input, *scheduler);
  for (int round = 0; round < 6; ++round) {
    wire.run(3s);
    for (DeviceIndex device = 0; device < input.devices.size(); ++device)
      scheduler->set_response_time(device, test::kRegisters,
                                   std::chrono::microseconds{200 + random() % 20'000});
    const auto draft = scheduler->draft();
    ASSERT_NE(draft, nullptr);
    wire.run(std::chrono::milliseconds{random() % 500});
    for (int change = 0; change < 30; ++change) {
      const auto point = static_cast<PointIndex>(random() % input.points.size());
      input.points[point].mode = random() % 2 ? Mode::kOnDemand : Mode::kScheduled;
      scheduler->set_point(point, input.points[point], wire.now());
      if (change % 10 == 0) wire.run(50ms);
    }
    if (round % 2)
      scheduler->set_longest(0, test::kRegisters, 8 + static_cast<std::uint32_t>(random() % 60));
    draft->make();
    scheduler->adopt(*draft, wire.now());
  }
  wire.run(2min);
  wire.forget_gaps();
  wire.run(3min);
  EXPECT_LT(scheduler->stretch(), 1.5);
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    if (input.points[point].mode == Mode::kOnDemand) {
      EXPECT_EQ(wire.seen(point).count, 0u) << "nobody asks for it";
    } else {
      EXPECT_LT(wire.seen(point).longest, 1.05 * scheduler->stretch() * input.points[point].refresh)
          << point;
      EXPECT_GT(wire.seen(point).count, 0u) << point;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ChangingBus, testing::Range<std::uint64_t>(1, 21));

PlanRunner runner_of(const ScheduleInput& input, Planner planner = Planner::kCyclic) {
  const WireModel wire(input, planner);
  const PlanBasis basis{wire, planned_points(input, wire.layout), 1, {}};
  return {wire, basis.points, make_plans(basis, group_points(basis)).front()};
}

ScheduleInput plant_at(double load) {
  const test::Map map = test::random_map(2, 60);
  return test::input_of(map, kFakeProtocol, 19200, 5ms, test::least_load(map, 19200, 5ms) / load);
}

TEST(Rehearsal, APlanForALightWireKeepsEveryRefresh) {
  EXPECT_EQ(count_late(runner_of(plant_at(0.3)), Instant{1s}), 0u);
}

TEST(Rehearsal, IntensivePointsAreNeverLate) {
  ScheduleInput input = plant_at(0.3);
  for (std::size_t i = 0; i < input.points.size(); i += 4) {
    input.points[i].mode = Mode::kIntensive;
    input.points[i].refresh = 1ms;
  }
  EXPECT_EQ(count_late(runner_of(input), Instant{1s}), 0u);
}

TEST(Rehearsal, DevicesThatRespondLaterThanPlannedMakePointsLate) {
  PlanRunner runner = runner_of(plant_at(0.5));
  for (DeviceIndex device = 0; device < runner.wire().tails.size(); ++device)
    runner.set_response_time(device, test::kRegisters, 40ms);
  EXPECT_GT(count_late(runner, Instant{1s}), 0u);
  EXPECT_EQ(count_late(runner, Instant{1s}, 3), 3u) << "enough";
}

TEST(Rehearsal, LeavesTheRunnerAsItIs) {
  PlanRunner runner = runner_of(plant_at(0.4));
  const Decision before = PlanRunner(runner).next(Instant{1s});
  (void)count_late(runner, Instant{1s});
  const Decision after = runner.next(Instant{1s});
  EXPECT_EQ(std::get<Block>(before).points, std::get<Block>(after).points);
}

}  // namespace
}  // namespace fieldcast
