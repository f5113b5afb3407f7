#include <gtest/gtest.h>

#include "core/dispatch/plan_draft.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;

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

TEST(Rehearsal, DevicesThatAnswerLaterThanPlannedMakePointsLate) {
  PlanRunner runner = runner_of(plant_at(0.5));
  for (DeviceIndex device = 0; device < runner.wire().tails.size(); ++device)
    runner.set_answer_time(device, test::kRegisters, 40ms);
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
