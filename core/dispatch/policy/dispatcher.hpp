// Follows the timetable: selects the read that is due first; spare wire time is used for other
// reads. Holds only scratch memory.
#pragma once

#include <algorithm>
#include <concepts>
#include <variant>
#include <vector>

#include "core/dispatch/policy/dispatch_state.hpp"
#include "core/dispatch/policy/look_ahead.hpp"
#include "core/model/planner_choice.hpp"

namespace fieldcast {

class CyclicDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now);
  [[nodiscard]] Duration slack(const ReadPlan& plan, const DispatchState& state, Instant now) const;
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now);
  // A point that was read early keeps its due time.
  void renew(const ReadPlan& plan, DispatchState& state, OrderIndex index, Instant acquired) const;
  void forget() {}

 private:
  [[nodiscard]] bool delays_another(const DispatchState& state, Instant due, Instant end);

  std::vector<std::size_t> walk_;  // scratch of delays_another()
};

// Common part of the dispatchers without a timetable, for planners that only serve comparison.
class LookAheadDispatcher {
 public:
  [[nodiscard]] Duration slack(const ReadPlan& plan, const DispatchState& state, Instant now) {
    if (state.queues.due.empty()) return Duration::max();
    return std::max(Duration::zero(), look_ahead_.rest(plan, state, now));
  }
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex group, Instant due,
               Instant now) {
    look_ahead_.enqueue(plan, state, group, due, now);
  }
  void renew(const ReadPlan&, DispatchState& state, OrderIndex index, Instant acquired) const {
    LookAhead::renew(state.points[index], acquired);
  }

 protected:
  LookAhead look_ahead_;
};

// Reads up to twenty of the most urgent groups, then selects again.
class DynamicBlocksDispatcher : public LookAheadDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now);
  void forget() { batch_.clear(); }

 private:
  void fill(const ReadPlan& plan, DispatchState& state, Instant now);

  static constexpr std::size_t kMostBatch = 20;
  std::vector<Block> batch_;  // last first
};

// Earliest due first.
class EarliestDueDispatcher : public LookAheadDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now);
  void forget() {}
};

// For a bus without periods: always selects the group with the least time left. Stateless.
class IntensiveDispatcher {
 public:
  [[nodiscard]] Decision next(const ReadPlan& plan, DispatchState& state, Instant now) const {
    if (state.queues.due.empty()) return Rest{state.next_wake()};
    const GroupIndex group = state.queues.due.top();
    return state.make_block(plan, group, state.groups[group].urgent, now, Duration::zero());
  }
  [[nodiscard]] Duration slack(const ReadPlan&, const DispatchState& state, Instant now) const {
    if (state.queues.due.empty()) return Duration::max();
    const GroupState& first = state.groups[state.queues.due.top()];
    return std::max(Duration::zero(), first.due - first.cost - now);
  }
  void enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex index, Instant due,
               Instant now) const {
    state.set_next_read(plan, index, due, now);
    state.queues.due.put(index, due);
  }
  void renew(const ReadPlan&, DispatchState& state, OrderIndex index, Instant acquired) const {
    PointState& point = state.points[index];
    point.due = point.deadline = later(acquired, point.allowed_gap);
  }
  void forget() const {}
};

// (plan, state, now) -> a read or a rest. A copy includes the decisions made ahead.
template <typename D>
concept ReadDispatcher = std::copyable<D> &&
    requires(D dispatcher, const D& constant, const ReadPlan& plan, DispatchState& state,
             OrderIndex point, GroupIndex index, Instant at) {
  // REQUIRES: the wire is free.
  { dispatcher.next(plan, state, at) } -> std::same_as<Decision>;
  // How long the wire may be used otherwise without delaying a point.
  { dispatcher.slack(plan, state, at) } -> std::same_as<Duration>;
  // A group has a new next read, due at the first time; the second one is now.
  { dispatcher.enqueue(plan, state, index, at, at) } -> std::same_as<void>;
  { constant.renew(plan, state, point, at) } -> std::same_as<void>;
  { dispatcher.forget() } -> std::same_as<void>;
};

using Dispatcher = std::variant<CyclicDispatcher, IntensiveDispatcher, EarliestDueDispatcher,
                                DynamicBlocksDispatcher>;
static_assert(ReadDispatcher<CyclicDispatcher> && ReadDispatcher<IntensiveDispatcher> &&
              ReadDispatcher<EarliestDueDispatcher> && ReadDispatcher<DynamicBlocksDispatcher>);

[[nodiscard]] inline Dispatcher make_dispatcher(Planner planner, const ReadPlan& plan) {
  if (plan.table && plan.table->empty()) return IntensiveDispatcher{};
  if (plan.table) return CyclicDispatcher{};
  if (planner == Planner::kDynamicBlocks) return DynamicBlocksDispatcher{};
  return EarliestDueDispatcher{};
}

}  // namespace fieldcast
