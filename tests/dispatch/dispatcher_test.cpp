#include "core/dispatch/policy/dispatcher.hpp"

#include <gtest/gtest.h>

#include "core/plan/planner.hpp"
#include "tests/plan/maps.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::kFakeProtocol;
constexpr Instant kNow{100s};

struct Bench {
  explicit Bench(std::vector<double> refreshes, Planner planner = Planner::kCyclic,
                 Mode mode = Mode::kScheduled)
      : input(map_of(refreshes, mode)), plan(plan_of(input, planner)), state(state_of(planner)) {
    for (PointState& point : state.points)
      point.allowed_gap = allowed_gap_of(ns(point.refresh), state.wire.lead);
  }
  template <typename D>
  void set_due(D& dispatcher, GroupIndex group, Instant due, bool eager = false) {
    PointState& point = state.points_of(plan, group).front();
    point.due = point.deadline = due;
    point.eager = eager;
    point.period = plan.points[group].period;
    dispatcher.enqueue(plan, state, group, state.find_urgent(plan, group, kNow), kNow);
  }
  template <typename D>
  [[nodiscard]] Decision next(D& dispatcher) {
    return dispatcher.next(plan, state, kNow);
  }

  static ScheduleInput map_of(const std::vector<double>& refreshes, Mode mode) {
    test::Map map;
    for (const double refresh : refreshes)
      map.push_back({1, static_cast<std::uint32_t>(1000 * map.size()), refresh});
    ScheduleInput made = test::input_of(map, kFakeProtocol);
    for (Point& point : made.points) point.mode = mode;
    return made;
  }
  static ReadPlan plan_of(const ScheduleInput& input, Planner planner) {
    const WireModel wire(input, planner);
    const PlanBasis basis{wire, planned_points(input, wire.layout), 1, {}};
    return make_plans(basis, group_points(basis)).front();
  }
  [[nodiscard]] DispatchState state_of(Planner planner) const {
    const WireModel wire(input, planner);
    return {wire, planned_points(input, wire.layout), plan};
  }

  ScheduleInput input;
  ReadPlan plan;
  DispatchState state;
};

PointIndex point_of(const Decision& decision) { return std::get<Block>(decision).points.front(); }
Instant rest_of(const Decision& decision) { return std::get<Rest>(decision).until; }

template <typename D>
class AnyDispatcher : public testing::Test {};
using All = testing::Types<CyclicDispatcher, IntensiveDispatcher, EarliestDueDispatcher,
                           DynamicBlocksDispatcher>;
TYPED_TEST_SUITE(AnyDispatcher, All);

TYPED_TEST(AnyDispatcher, RestsForEverWhenThereIsNothingToRead) {
  Bench bench({1, 1});
  TypeParam dispatcher;
  EXPECT_EQ(rest_of(bench.next(dispatcher)), kNever);
  EXPECT_EQ(dispatcher.slack(bench.plan, bench.state, kNow), Duration::max());
}

TYPED_TEST(AnyDispatcher, ReadsWhatIsOverdueTheMostUrgentFirst) {
  Bench bench({1, 1, 1});
  TypeParam dispatcher;
  bench.set_due(dispatcher, 0, kNow - 1ms);
  bench.set_due(dispatcher, 1, kNow - 3ms);
  bench.set_due(dispatcher, 2, kNow - 2ms);
  EXPECT_EQ(point_of(bench.next(dispatcher)), 1u);
  EXPECT_EQ(dispatcher.slack(bench.plan, bench.state, kNow), 0ns);
}

TYPED_TEST(AnyDispatcher, APointIsDueAgainWithinItsAllowedGap) {
  Bench bench({1});
  TypeParam dispatcher;
  PointState& point = bench.state.points[0];
  dispatcher.renew(bench.plan, bench.state, 0, kNow);
  EXPECT_EQ(point.deadline, kNow + point.allowed_gap);
  EXPECT_LE(point.due, point.deadline);
  EXPECT_GT(point.due, kNow);
}

TEST(CyclicDispatcher, HoldsAReadUntilItMayBegin) {
  Bench bench({1, 1});
  CyclicDispatcher dispatcher;
  bench.set_due(dispatcher, 0, kNow + 500ms);
  bench.set_due(dispatcher, 1, kNow + 600ms);
  const Instant until = rest_of(bench.next(dispatcher));
  EXPECT_LT(until, kNow + 500ms);
  EXPECT_GT(until, kNow + 400ms);
  EXPECT_EQ(dispatcher.slack(bench.plan, bench.state, kNow), until - kNow);
}

TEST(CyclicDispatcher, AReadThatWouldDelayAMoreUrgentOneWaits) {
  Bench bench({1, 10});
  CyclicDispatcher dispatcher;
  const Duration cost = 60ms;
  bench.set_due(dispatcher, 1, kNow - 1ms);
  bench.state.groups[1].cost = cost;
  bench.set_due(dispatcher, 0, kNow - 2ms);
  bench.state.queues.take_out(0);
  bench.state.queues.held.put(0, kNow + cost / 2);  // starts before the other would end
  EXPECT_EQ(rest_of(bench.next(dispatcher)), kNow + cost / 2);
}

TEST(CyclicDispatcher, WireTimeToSpareGoesToThoseWhoWantIt) {
  Bench bench({1, 10});
  CyclicDispatcher dispatcher;
  bench.set_due(dispatcher, 0, kNow + 500ms);
  bench.set_due(dispatcher, 1, kNow + 9s, true);
  EXPECT_EQ(point_of(bench.next(dispatcher)), 1u);
}

TEST(CyclicDispatcher, APointReadEarlyKeepsItsInstant) {
  Bench bench({1});
  CyclicDispatcher dispatcher;
  PointState& point = bench.state.points[0];
  point.eager = false;
  point.due = kNow + point.allowed_gap * 8 / 10;
  const Instant due = point.due;
  dispatcher.renew(bench.plan, bench.state, 0, kNow);
  EXPECT_EQ(point.due, due);
}

TEST(IntensiveDispatcher, NeverRests) {
  Bench bench({1, 2}, Planner::kCyclic, Mode::kIntensive);
  IntensiveDispatcher dispatcher;
  bench.set_due(dispatcher, 0, kNow + 900ms);
  bench.set_due(dispatcher, 1, kNow + 500ms);
  EXPECT_EQ(point_of(bench.next(dispatcher)), 1u);
}

TEST(EarliestDueDispatcher, RestsAsLongAsAllAreInTime) {
  Bench bench({1, 1}, Planner::kFastestMember);
  EarliestDueDispatcher dispatcher;
  bench.set_due(dispatcher, 0, kNow + 900ms);
  bench.set_due(dispatcher, 1, kNow + 900ms);
  const Instant until = rest_of(bench.next(dispatcher));
  EXPECT_LT(until, kNow + 900ms - 2 * bench.state.groups[0].cost);
  EXPECT_GT(until, kNow + 500ms);
}

TEST(DynamicBlocksDispatcher, ReadsItsBatchToTheEndUnlessItIsVoid) {
  Bench bench({1, 1, 1}, Planner::kDynamicBlocks);
  DynamicBlocksDispatcher dispatcher;
  for (GroupIndex group = 0; group < 3; ++group)
    bench.set_due(dispatcher, group, kNow - 1ms * (3 - static_cast<int>(group)));
  EXPECT_EQ(point_of(bench.next(dispatcher)), 0u);
  bench.set_due(dispatcher, 2, kNow - 1s);
  EXPECT_EQ(point_of(bench.next(dispatcher)), 1u) << "decided before";
  dispatcher.forget();
  EXPECT_EQ(point_of(bench.next(dispatcher)), 2u);
}

TEST(Dispatcher, FollowsFromThePlan) {
  const auto holds = [](const Bench& bench, Planner planner) {
    return make_dispatcher(planner, bench.plan).index();
  };
  EXPECT_EQ(holds(Bench({1}), Planner::kCyclic), Dispatcher(CyclicDispatcher{}).index());
  EXPECT_EQ(holds(Bench({1}, Planner::kCyclic, Mode::kIntensive), Planner::kCyclic),
            Dispatcher(IntensiveDispatcher{}).index());
  EXPECT_EQ(holds(Bench({1}, Planner::kDynamicBlocks), Planner::kDynamicBlocks),
            Dispatcher(DynamicBlocksDispatcher{}).index());
  EXPECT_EQ(holds(Bench({1}, Planner::kOnePerChannel), Planner::kOnePerChannel),
            Dispatcher(EarliestDueDispatcher{}).index());
}

}  // namespace
}  // namespace fieldcast
