#include "core/dispatch/policy/earliest_due_dispatcher.hpp"

namespace fieldcast {

Decision EarliestDueDispatcher::next(const ReadPlan& plan, DispatchState& state, Instant now) {
  const GroupQueues& queues = state.queues;
  if (queues.due.empty()) return Rest{state.next_wake()};
  const Duration free = look_ahead_.rest(plan, state, now);
  const GroupIndex first = queues.due.top();
  if (free > Duration::zero()) {
    if (queues.spare.empty()) return Rest{std::min(later(now, free), state.next_wake())};
    if (queues.spare.top() != first) {
      if (auto block = state.spare_read(plan, now, free)) return *std::move(block);
    }
  }
  return state.make_block(plan, first, state.groups[first].urgent, now, Duration::zero());
}

}  // namespace fieldcast
