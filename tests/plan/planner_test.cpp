#include "core/plan/planner.hpp"

#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;

ScheduleInput plant(std::uint64_t seed, double stretch = 1) {
  return test::input_of(test::random_map(seed, 120), kFakeProtocol, 19200, 5ms, stretch);
}

struct Planned {
  explicit Planned(const ScheduleInput& input)
      : wire(input, Planner::kCyclic), points(planned_points(input, wire.layout)) {}
  [[nodiscard]] PlanBasis basis() const { return {wire, points, 1, {}}; }
  [[nodiscard]] std::vector<ReadPlan> make() const {
    return make_plans(basis(), group_points(basis()));
  }
  [[nodiscard]] std::vector<PointState> states(const ReadPlan& plan) const {
    std::vector<PointState> states;
    for (OrderIndex at = 0; at < points.size(); ++at) {
      states.push_back(PointState{points[at]});
      states.back().stretch = plan.points[at].stretch;
    }
    return states;
  }
  WireModel wire;
  std::vector<PlannedPoint> points;
};

TEST(Planner, TheSamePointsMakeTheSamePlanOnAnyThread) {
  const ScheduleInput input = plant(1, 3);
  const std::vector<ReadPlan> here = Planned(input).make();
  std::vector<ReadPlan> there;
  std::thread([&] { there = Planned(input).make(); }).join();
  EXPECT_EQ(here, there);
  EXPECT_NE(here.front(), Planned(plant(1, 4)).make().front());
}

TEST(Planner, EveryPointIsInOneGroup) {
  const ReadPlan plan = Planned(plant(2)).make().front();
  std::set<PointIndex> seen(plan.order.begin(), plan.order.end());
  EXPECT_EQ(seen.size(), plan.points.size());
  OrderIndex next = 0;
  for (const Group& group : plan.grouping.groups) {
    EXPECT_EQ(group.begin, next);
    EXPECT_LT(group.begin, group.end);
    next = group.end;
  }
  EXPECT_EQ(next, plan.points.size());
}

TEST(Planner, OtherTimetablesAreForTheSameGroups) {
  const std::vector<ReadPlan> plans = Planned(plant(3, 3)).make();
  ASSERT_GT(plans.size(), 1u);
  for (const ReadPlan& plan : plans) {
    EXPECT_EQ(plan.grouping, plans.front().grouping);
    EXPECT_EQ(plan.stretch, plans.front().stretch);
    EXPECT_EQ(plan.slot(), plans.front().slot());
  }
}

TEST(Planner, OverloadIsStretchedUntilTheWireCarriesIt) {
  const ReadPlan plan = Planned(plant(4, 0.1)).make().front();
  EXPECT_GT(plan.load, 1);
  EXPECT_GT(plan.stretch, plan.load * 0.9);
  EXPECT_LE(plan.table->load(), 1);
  for (OrderIndex at = 0; at < plan.points.size(); ++at)
    EXPECT_EQ(plan.points[at].stretch, plan.stretch);
}

TEST(Planner, AmendingForNothingChangesNothing) {
  const Planned planned(plant(5, 3));
  const ReadPlan plan = planned.make().front();
  const std::vector<GroupIndex> changed{0, 1};
  EXPECT_EQ(amended(plan, planned.wire, planned.states(plan), changed), plan);
}

TEST(Planner, AnAmendedPlanLeavesOtherGroupsAlone) {
  Planned planned(plant(6, 3));
  const ReadPlan plan = planned.make().front();
  std::vector<PointState> states = planned.states(plan);
  for (OrderIndex at = plan.grouping.groups[0].begin; at < plan.grouping.groups[0].end; ++at)
    states[at].refresh *= 4;
  const std::vector<GroupIndex> changed{0};
  const ReadPlan other = amended(plan, planned.wire, states, changed);
  EXPECT_GT(other.groups[0].period, plan.groups[0].period);
  EXPECT_LT(other.groups[0].load, plan.groups[0].load);
  for (GroupIndex group = 1; group < plan.groups.size(); ++group)
    EXPECT_EQ(other.groups[group].period, plan.groups[group].period) << group;
  for (OrderIndex at = plan.grouping.groups[1].begin; at < plan.points.size(); ++at) {
    EXPECT_EQ(other.points[at].first_slot, plan.points[at].first_slot) << at;
    EXPECT_EQ(other.points[at].every, plan.points[at].every) << at;
  }
}

TEST(Planner, LoadIsThatOfWhatIsAskedForNow) {
  Planned planned(plant(7, 20));
  const ReadPlan plan = planned.make().front();
  EXPECT_NEAR(load_of(planned.basis(), plan), plan.load, 1e-12);
  for (PlannedPoint& point : planned.points) point.refresh *= 2;
  EXPECT_NEAR(load_of(planned.basis(), plan), plan.load / 2, 0.1 * plan.load);
}

}  // namespace
}  // namespace fieldcast
