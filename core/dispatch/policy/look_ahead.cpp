#include "core/dispatch/policy/look_ahead.hpp"

#include <algorithm>

namespace fieldcast {

namespace {

constexpr auto kSooner = [](const auto& a, const auto& b) { return a.due > b.due; };

}  // namespace

void LookAhead::push(const Ahead& ahead) {
  heap_.push_back(ahead);
  std::push_heap(heap_.begin(), heap_.end(), kSooner);
}

LookAhead::Ahead LookAhead::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), kSooner);
  const Ahead ahead = heap_.back();
  heap_.pop_back();
  return ahead;
}

// If a read ends before it is due, the wire may rest for at most the difference. A group that is
// read early is due earlier the next time.
Duration LookAhead::rest(const ReadPlan& plan, const DispatchState& state, Instant now) {
  const DueQueue& due = state.queues.due;
  const Duration silence = state.wire.silence;
  const GroupIndex first = due.top();
  const Duration own = coming_[first][0].cost;
  Duration others = Duration::max();  // rest allowed by all but the first
  Instant end = now;                  // of the reads so far, without the first
  heap_.clear();
  push({due.top_key(), first, 0, 0});
  for (unsigned count = 0; count < state.wire.weights.look_ahead && !heap_.empty(); ++count) {
    const Ahead ahead = pop();
    if (ahead.due == kNever) break;
    const auto& coming = coming_[ahead.group];
    Duration early{};
    if (count > 0) {
      end = later(end, coming[ahead.step].cost);
      others = std::min(others, ahead.due + silence - end);
      if (others <= own) break;
      early = std::max(Duration::zero(), ahead.due - later(end, others));
    }
    if (ahead.step + 1u < kReads) {
      const Coming& next = coming[ahead.step + 1];
      push({next.again ? next.due - early : next.due, ahead.group, kNoNode,
            (ahead.step + 1u) & 15u});
    }
    if (ahead.node == kNoNode) continue;
    const std::size_t child = 2 * std::size_t{ahead.node} + 1;
    for (std::size_t node = child; node <= child + 1 && node < due.size(); ++node)
      push({due.key(due.at(node)), due.at(node), static_cast<std::uint32_t>(node) & kNoNode, 0});
  }
  const Duration budget = std::min(others, due.top_key() + silence - now);
  return budget - own - part_of(kReserve, plan.fastest);
}

void LookAhead::enqueue(const ReadPlan& plan, DispatchState& state, GroupIndex index, Instant due,
                        Instant now) {
  coming_.resize(state.groups.size());
  state.queues.due.put(index, due);
  const auto points = state.points_of(plan, index);
  imagined_.assign(points.begin(), points.end());
  std::uint32_t urgent = state.groups[index].urgent;
  for (Coming& coming : coming_[index]) {
    PointState& head = imagined_[urgent];
    const Instant at = std::max(now, head.due);
    const Selection& read = state.select(plan, index, imagined_, urgent, at, Duration::zero());
    coming = {head.due, read.cost, head.again};
    for (const std::uint32_t i : read.members) {
      renew(imagined_[i], at);
      imagined_[i].again = true;
    }
    for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
      if (imagined_[i].ready(now) && imagined_[i].due < imagined_[urgent].due) urgent = i;
    }
  }
  state.groups[index].due = coming_[index][0].due;
  state.groups[index].cost = coming_[index][0].cost;
}

}  // namespace fieldcast
