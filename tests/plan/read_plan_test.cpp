#include "core/plan/read_plan.hpp"

#include <gtest/gtest.h>

#include "core/plan/planner.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;

ReadPlan plan_of(const ScheduleInput& input, Planner planner = Planner::kCyclic) {
  const WireModel wire(input, planner);
  const PlanBasis basis{wire, planned_points(input, wire.layout), 1, {}};
  return make_plans(basis, group_points(basis)).front();
}

// The points of the drawing in the header: a is between b and c, d is far away.
ScheduleInput drawn() {
  return test::input_of({{1, 0, 0.4}, {1, 5, 0.1}, {1, 10, 0.4}, {1, 4000, 0.2}}, kFakeProtocol);
}

TEST(ReadPlan, IsAsItsHeaderDraws) {
  const ReadPlan plan = plan_of(drawn());
  const auto slots = [&](Duration time) { return time / plan.slot(); };
  ASSERT_EQ(plan.grouping.groups.size(), 2u);
  EXPECT_EQ(slots(plan.hyperperiod()), 4);
  EXPECT_EQ(slots(plan.groups[0].period), 1);
  EXPECT_EQ(slots(plan.groups[1].period), 2);
  EXPECT_EQ(slots(plan.points[1].period), 1) << "a";
  EXPECT_EQ(slots(plan.points[0].period), 4) << "b";
  EXPECT_EQ(slots(plan.points[2].period), 4) << "c";
  EXPECT_EQ(slots(plan.points[3].period), 2) << "d";
  EXPECT_NE(slots(plan.points[0].phase), slots(plan.points[2].phase)) << "b and c have a slot each";
  for (const OrderIndex slow : {0u, 2u}) {
    EXPECT_NE(slots(plan.points[slow].phase) % 2, slots(plan.points[3].phase))
        << "the slot of d is long enough";
  }
}

TEST(ReadPlan, NothingIsReadLessOftenThanItsRefreshAsks) {
  const ScheduleInput input =
      test::input_of(test::random_map(3, 200), kFakeProtocol, 115200, 2ms, 3);
  const ReadPlan plan = plan_of(input);
  ASSERT_EQ(plan.stretch, 1);
  for (OrderIndex at = 0; at < plan.points.size(); ++at) {
    const Duration refresh = input.points[plan.order[at]].refresh;
    ASSERT_TRUE(plan.points[at].worst_gap);
    EXPECT_LE(*plan.points[at].worst_gap, refresh);
    EXPECT_LE(plan.points[at].period, *plan.points[at].worst_gap);
    EXPECT_EQ(plan.points[at].period % plan.slot(), 0ns);
    EXPECT_EQ(plan.hyperperiod() % plan.points[at].period, 0ns);
  }
}

TEST(ReadPlan, ItsLoadIsThatOfItsGroups) {
  const ReadPlan plan =
      plan_of(test::input_of(test::random_map(4, 100), kFakeProtocol, 115200, 2ms));
  double sum = 0;
  for (const PlannedGroup& group : plan.groups) sum += group.load;
  EXPECT_NEAR(sum, plan.planned_load(), 1e-9);
}

TEST(ReadPlan, WhatHasNoPeriodHasNoWorstGap) {
  ScheduleInput input = drawn();
  input.points[3].mode = Mode::kIntensive;
  const ReadPlan plan = plan_of(input);
  EXPECT_EQ(plan.groups[1].period, 0ns);
  EXPECT_FALSE(plan.points[3].worst_gap);
  EXPECT_GT(plan.groups[1].load, 0);
  EXPECT_FALSE(plan_of(drawn(), Planner::kFastestMember).points[0].worst_gap) << "no timetable";
}

}  // namespace
}  // namespace fieldcast
