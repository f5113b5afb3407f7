#include "core/dispatch/plan_runner.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

void OverrunWatch::wire_free(Instant now, bool rests) {
  if (rests_since_ < now) rested_ += now - rests_since_;
  rests_since_ = rests ? now : kNever;
}

void OverrunWatch::acquired(bool late, Instant now) {
  constexpr std::uint32_t kWindow = 256;
  constexpr double kRests = 0.02, kMore = 1.05, kLess = 0.99;
  if (now < settled_at_) return;
  if (watched_ == 0) window_began_ = now, rested_ = Duration::zero();
  late_ += late ? 1 : 0;
  if (++watched_ < kWindow) return;
  const bool rests = ns(rested_) > kRests * ns(now - window_began_);
  if (late_ > kWindow / 20 && !rests) overrun_ = std::min(kMost, overrun_ * kMore);
  if (late_ == 0 || rests) overrun_ = std::max(1.0, overrun_ * kLess);
  late_ = watched_ = 0;
}

void RefusalSearch::cut(std::span<PointState> points, std::span<const OrderIndex> refused,
                        Instant now, Duration forget) {
  const OrderIndex begin = refused.front(), end = refused.back() + 1;
  for (Node& node : open_) {
    if (begin >= node.begin && end <= node.end) node.half_refused = true;
  }
  const OrderIndex middle = refused[refused.size() / 2];
  points[middle].cut_until = later(now, forget);
  for (const OrderIndex index : refused) {
    if (points[index].wanted() && !points[index].bad) points[index].suspect = true;
  }
  if (open_.size() >= kMostOpen) open_.erase(open_.begin());
  open_.push_back({begin, middle, end});
}

void RefusalSearch::mark_bad(std::span<PointState> points, OrderIndex index, Instant now,
                             Duration forget) {
  for (Node& node : open_) {
    if (index >= node.begin && index < node.end) node.half_refused = true;
  }
  PointState& point = points[index];
  point.bad = true;
  point.suspect = false;
  point.eager = false;
  point.retry_at = later(now, forget);
}

void RefusalSearch::settle(std::span<PointState> points, OrderIndex begin, OrderIndex end) {
  const auto complete = [&](const Node& node) {
    if (node.end <= begin || node.begin >= end) return false;
    for (OrderIndex index = node.begin; index < node.end; ++index) {
      if (points[index].suspect && points[index].wanted()) return false;
    }
    if (node.half_refused) points[node.middle].cut_until = Instant{};
    return true;
  };
  std::erase_if(open_, complete);
}

PlanRunner::PlanRunner(WireModel wire, std::span<const PlannedPoint> points, ReadPlan plan)
    : plan_(std::move(plan)),
      state_(std::move(wire), points, plan_),
      dispatcher_(make_dispatcher(state_.wire.planner, plan_)) {
  for (OrderIndex index = 0; index < state_.points.size(); ++index) {
    state_.points[index].stretch = plan_.points[index].stretch;
    set_allowed_gap(state_.points[index]);
  }
}

void PlanRunner::inherit(PointIndex point, Instant acquired) {
  inherited_.emplace_back(index_of(point), acquired);
}

Decision PlanRunner::next(Instant now) {
  seen_ = decided_ = now;
  wake(now);
  Decision decision = std::visit(
      [&](auto& dispatcher) { return dispatcher.next(plan_, state_, now); }, dispatcher_);
  watch_.wire_free(now, std::holds_alternative<Rest>(decision));
  return decision;
}

Duration PlanRunner::slack(Instant now) {
  wake(now);
  return std::visit([&](auto& dispatcher) { return dispatcher.slack(plan_, state_, now); },
                    dispatcher_);
}

void PlanRunner::begin(Instant now) {
  begun_ = true;
  state_.table_began = now;
  for (GroupIndex group = 0; group < state_.groups.size(); ++group) take_phases(group);
  watch_.plan_began(later(now, plan_.hyperperiod()));
  for (OrderIndex index = 0; index < state_.points.size(); ++index) {
    PointState& point = state_.points[index];
    point.due = point.deadline = later(now, point.allowed_gap);
    if (point.period > Duration::zero())
      point.due = std::min(now + plan_.points[index].phase, point.deadline);
  }
  for (const auto& [index, acquired] : std::exchange(inherited_, {})) {
    PointState& point = state_.points[index];
    const Instant until = std::max(now, later(acquired, point.allowed_gap));
    if (until >= point.due) continue;
    point.due = point.deadline = until;
    point.eager = true;  // it may be late, but the plan is not the reason
  }
  refresh_all(now);
}

void PlanRunner::wake(Instant now) {
  if (!begun_) begin(now);
  if (!changed_.empty()) settle_changes(now);
  GroupQueues& queues = state_.queues;
  while (!state_.suspended.empty() && state_.suspended.top_key() <= now) {
    const auto device = static_cast<DeviceIndex>(state_.suspended.top());
    state_.suspended.remove(device);
    for (const GroupIndex group : plan_.grouping.groups_of[device]) {
      for (PointState& point : state_.points_of(plan_, group)) {
        if (point.due <= now) postpone(point, now);
      }
      refresh(group, now);
    }
  }
  while (!queues.held.empty() && queues.held.top_key() <= now) {
    const GroupIndex group = queues.held.top();
    queues.held.remove(group);
    queues.due.put(group, state_.groups[group].due);
  }
  while (!queues.asleep.empty() && queues.asleep.top_key() <= now) {
    const GroupIndex group = queues.asleep.top();
    queues.asleep.remove(group);
    for (PointState& point : state_.points_of(plan_, group)) {
      if (point.bad && point.retry_at <= now) postpone(point, now);
    }
    refresh(group, now);
  }
}

void PlanRunner::refresh(GroupIndex group, Instant now) {
  const Instant due = state_.find_urgent(plan_, group, now);
  if (due == kNever) return;
  std::visit([&](auto& dispatcher) { dispatcher.enqueue(plan_, state_, group, due, now); },
             dispatcher_);
}

void PlanRunner::refresh_all(Instant now) {
  for (GroupIndex group = 0; group < state_.groups.size(); ++group) refresh(group, now);
}

void PlanRunner::refresh_groups_of(const Block& block, Instant now) {
  GroupIndex last = ~0u;
  for (const PointIndex point : block.points) {
    const GroupIndex group = plan_.grouping.group_at[index_of(point)];
    if (group != last) refresh(group, now);
    last = group;
  }
}

// The point is due after half an allowed gap, earlier if the wire would rest.
void PlanRunner::postpone(PointState& point, Instant from) {
  point.due = point.deadline = later(from, point.allowed_gap / 2);
  point.eager = true;
}

void PlanRunner::acquired(const Block& block, Instant now) {
  seen_ = now;
  state_.paces[block.device].read(now - decided_, block.cost - state_.wire.tails[block.device]);
  std::visit([&](const auto& dispatcher) { renew(block, now, dispatcher); }, dispatcher_);
  confirmed(block, now);
}

void PlanRunner::launched(const Block& block, Instant now) {
  std::visit([&](const auto& dispatcher) { renew(block, now, dispatcher); }, dispatcher_);
  refresh_groups_of(block, now);
}

void PlanRunner::confirmed(const Block& block, Instant now) {
  for (const PointIndex each : block.points) {
    PointState& point = state_.points[index_of(each)];
    point.retry_at = Instant{};
    point.bad = point.suspect = false;
  }
  if (refusals_.searching()) settle_refusals(block);
  refresh_groups_of(block, now);
}

template <typename D>
void PlanRunner::renew(const Block& block, Instant now, const D& dispatcher) {
  for (const PointIndex each : block.points) {
    const OrderIndex index = index_of(each);
    PointState& point = state_.points[index];
    // Small delays do not count: the next slot has slack.
    if (!point.eager) watch_.acquired(now - point.deadline > point.allowed_gap / 20, now);
    dispatcher.renew(plan_, state_, index, now);
    if (point.bad) point.retry_at = later(now, point.allowed_gap);
    point.eager = false;
  }
}

void PlanRunner::settle_refusals(const Block& block) {
  OrderIndex low = ~0u, high = 0;
  for (const PointIndex each : block.points) {
    low = std::min(low, index_of(each));
    high = std::max(high, index_of(each) + 1);
  }
  if (low < high) refusals_.settle(state_.points, low, high);
}

void PlanRunner::failed(const Block& block, Instant now, Instant retry_at) {
  forget_decisions();
  for (const PointIndex each : block.points) {
    PointState& point = state_.points[index_of(each)];
    point.retry_at = retry_at;
    postpone(point, std::max(now, retry_at));
  }
  refresh_groups_of(block, now);
}

std::vector<PointIndex> PlanRunner::refused(const Block& block, Instant now, Duration forget) {
  std::vector<PointIndex> bad;
  forget_decisions();
  refused_.clear();
  for (const PointIndex each : block.points) {
    const OrderIndex index = index_of(each);
    refused_.push_back(index);
    PointState& point = state_.points[index];
    point.due = std::min(point.due, now);
    point.deadline = std::min(point.deadline, now);
    point.eager = true;  // a point under search is not late
  }
  if (refused_.empty()) return bad;
  std::ranges::sort(refused_);
  if (refused_.size() == 1) {
    refusals_.mark_bad(state_.points, refused_.front(), now, forget);
    refusals_.settle(state_.points, refused_.front(), refused_.front() + 1);
    bad.push_back(block.points.front());
  } else {
    refusals_.cut(state_.points, refused_, now, forget);
  }
  refresh_groups_of(block, now);
  return bad;
}

void PlanRunner::suspend(DeviceIndex device, Instant until) {
  forget_decisions();
  state_.suspended_until[device] = until;
  state_.suspended.put(device, until);
  for (const GroupIndex group : plan_.grouping.groups_of[device]) state_.queues.take_out(group);
}

void PlanRunner::forget_decisions() {
  std::visit([](auto& dispatcher) { dispatcher.forget(); }, dispatcher_);
}

void PlanRunner::forget_paces(Instant now) {
  const bool paced =
      std::ranges::any_of(state_.paces, [](const LinePace& pace) { return pace.share() < 1; });
  std::ranges::fill(state_.paces, LinePace{});
  if (paced && begun_) refresh_all(now);
}

}  // namespace fieldcast
