// For a bus without periods: always selects the group with the least time left. Stateless.
#pragma once

#include <algorithm>

#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {

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
  void renew(const DispatchState&, const GroupState&, PointState& point, Instant acquired) const {
    point.due = point.deadline = later(acquired, point.allowed_gap);
  }
  void forget() const {}
};

}  // namespace fieldcast
