#include "core/dispatch/policy/dispatcher.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

namespace {

// An even earlier read would have to be repeated.
Duration early_by(const ReadPlan& plan, GroupIndex group, const PointState& head) {
  constexpr double kWithoutPhase = 0.1;  // of the allowed gap, for reads without a phase
  const bool has_phase = !head.eager && head.period > Duration::zero();
  return has_phase ? plan.groups[group].slack : part_of(kWithoutPhase, head.allowed_gap);
}

Instant next_due(const ReadPlan& plan, const DispatchState& state, OrderIndex index,
                 Instant acquired) {
  const PointState& point = state.points[index];
  const Cycle& cycle = state.groups[plan.grouping.group_at[index]].cycle;
  if (point.mode == Mode::kIntensive || cycle.period == Duration::zero())
    return later(acquired, point.allowed_gap);
  if (point.period == Duration::zero()) return due_after(cycle, acquired, point.allowed_gap);
  return state.last_instant(plan, index, later(acquired, point.allowed_gap));
}

}  // namespace

Decision CyclicDispatcher::next(const ReadPlan& plan, DispatchState& state, Instant now) {
  constexpr std::size_t kExamined = 8;
  const GroupQueues& queues = state.queues;
  for (std::size_t node = 0; node < std::min(kExamined, queues.due.size()); ++node) {
    const GroupIndex group = queues.due.at(node);
    if (delays_another(state, queues.due.key(group), later(now, state.groups[group].cost)))
      continue;
    return state.make_block(plan, group, state.groups[group].urgent, now, Duration::zero());
  }
  const Instant until = queues.held.empty() ? kNever : queues.held.top_key();
  if (!queues.spare.empty()) {
    auto block = state.spare_read(plan, now, until == kNever ? Duration::max() : until - now);
    if (block) return *std::move(block);
  }
  return Rest{std::min(until, state.next_wake())};
}

// The other read begins before `end` and is due before `due`.
bool CyclicDispatcher::delays_another(const DispatchState& state, Instant due, Instant end) {
  const DueQueue& held = state.queues.held;
  walk_.assign(1, 0);
  while (!walk_.empty()) {
    const std::size_t node = walk_.back();
    walk_.pop_back();
    if (node >= held.size() || held.key(held.at(node)) >= end) continue;
    if (state.groups[held.at(node)].due < due) return true;
    walk_.push_back(2 * node + 1);
    walk_.push_back(2 * node + 2);
  }
  return false;
}

Duration CyclicDispatcher::slack(const ReadPlan&, const DispatchState& state, Instant now) const {
  const GroupQueues& queues = state.queues;
  Duration free = queues.held.empty() ? Duration::max() : queues.held.top_key() - now;
  if (!queues.due.empty()) {
    const GroupIndex first = queues.due.top();
    free = std::min(free, queues.due.top_key() - state.groups[first].cost - now);
  }
  return std::max(Duration::zero(), free);
}

void CyclicDispatcher::enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex index,
                               Instant due, Instant now) {
  state.set_next_read(plan, index, due, now);
  const GroupState& group = state.groups[index];
  const PointState& head = state.points_of(plan, index)[group.urgent];
  const Duration tail = state.wire.tails[plan.grouping.groups[index].device];
  // With a phase, the response must end then; without one, the wire must be free again.
  const bool has_phase = !head.eager && head.period > Duration::zero();
  const Instant release =
      due - group.cost + (has_phase ? tail : Duration::zero()) - early_by(plan, index, head);
  if (release <= now || head.mode == Mode::kIntensive)
    state.queues.due.put(index, due);
  else
    state.queues.held.put(index, release);
}

void CyclicDispatcher::renew(const ReadPlan& plan, DispatchState& state, OrderIndex index,
                             Instant acquired) const {
  PointState& point = state.points[index];
  const bool keeps = point.mode == Mode::kScheduled && !point.eager && !point.suspect;
  if (!keeps || point.used(acquired) >= state.wire.weights.keep)
    point.due = next_due(plan, state, index, acquired);
  point.deadline = later(acquired, point.allowed_gap);
}

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
  std::ranges::reverse(batch_);
}

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
