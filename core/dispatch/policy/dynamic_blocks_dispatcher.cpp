#include "core/dispatch/policy/dynamic_blocks_dispatcher.hpp"

#include <utility>

namespace fieldcast {

Decision DynamicBlocksDispatcher::next(const ReadPlan& plan, DispatchState& state, Instant now) {
  if (state.queues.due.empty()) return Rest{state.next_wake()};
  if (batch_.empty()) {
    const Duration free = look_ahead_.rest(plan, state, now);
    if (free > Duration::zero() && state.queues.spare.empty())
      return Rest{std::min(later(now, free), state.next_wake())};
    fill(plan, state, now);
  }
  Block block = std::move(batch_.back());
  batch_.pop_back();
  return block;
}

void DynamicBlocksDispatcher::fill(const ReadPlan& plan, DispatchState& state, Instant now) {
  const Duration reserve = part_of(LookAhead::kReserve, plan.fastest);
  DueQueue& due = state.queues.due;
  std::vector<std::pair<Instant, GroupIndex>> taken;
  Instant end = now;
  while (!due.empty() && taken.size() < kMostBatch) {
    const GroupIndex group = due.top();
    end = later(end, state.groups[group].cost);
    if (!taken.empty() && due.top_key() - end > reserve) break;
    taken.emplace_back(due.top_key(), group);
    batch_.push_back(
        state.make_block(plan, group, state.groups[group].urgent, now, Duration::zero()));
    due.remove(group);
  }
  for (const auto& [key, group] : taken) due.put(group, key);
  std::reverse(batch_.begin(), batch_.end());
}

}  // namespace fieldcast
