#include "core/dispatch/policy/dispatch_state.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

void GroupQueues::take_out(GroupIndex group) {
  due.remove(group);
  held.remove(group);
  spare.remove(group);
  asleep.remove(group);
}

DispatchState::DispatchState(WireModel model, std::span<const PlannedPoint> planned,
                             const ReadPlan& plan)
    : wire(std::move(model)),
      groups(plan.groups.size()),
      paces(wire.tails.size()),
      suspended_until(wire.tails.size()),
      suspended(wire.tails.size()),
      queues(plan.groups.size()),
      selector(wire.rules.shape, wire.weights) {
  points.reserve(planned.size());
  for (const PlannedPoint& point : planned) points.push_back(PointState{point});
}

std::span<PointState> DispatchState::points_of(const ReadPlan& plan, GroupIndex group) {
  const Group& from = plan.grouping.groups[group];
  return std::span(points).subspan(from.begin, from.end - from.begin);
}

const Selection& DispatchState::select(const ReadPlan& plan, GroupIndex group,
                                       std::span<const PointState> from, std::uint32_t urgent,
                                       Instant now, Duration budget) {
  return selector.select(wire.layout, plan.grouping.groups[group], from, urgent, now,
                         {budget, groups[group].cycle.period});
}

Block DispatchState::make_block(const ReadPlan& plan, GroupIndex group, std::uint32_t urgent,
                                Instant now, Duration budget) {
  const auto members = points_of(plan, group);
  const Selection& read = select(plan, group, members, urgent, now, budget);
  const Group& from = plan.grouping.groups[group];
  Block block;
  block.device = from.device;
  block.ranges = read.ranges();
  block.cost = read.cost;
  block.points.reserve(read.members.size());
  for (const std::uint32_t i : read.members) {
    if (members[i].ready(now)) block.points.push_back(plan.order[from.begin + i]);
  }
  return block;
}

std::optional<Block> DispatchState::spare_read(const ReadPlan& plan, Instant now, Duration free) {
  const GroupIndex group = queues.spare.top();
  Block block = make_block(plan, group, groups[group].spare_urgent, now, free);
  if (block.cost > free) return std::nullopt;
  return block;
}

void DispatchState::set_next_read(const ReadPlan& plan, GroupIndex index, Instant due,
                                  Instant now) {
  GroupState& group = groups[index];
  const DeviceIndex device = plan.grouping.groups[index].device;
  const Duration cost =
      selector.cost_of(wire.layout, plan.grouping.groups[index], points_of(plan, index),
                       group.urgent, std::max(now, due), {Duration::zero(), group.cycle.period});
  group.due = due;
  group.cost = paces[device].of(cost - wire.tails[device]) + wire.tails[device];
}

Instant DispatchState::next_wake() const {
  Instant at = kNever;
  if (!suspended.empty()) at = std::min(at, suspended.top_key());
  if (!queues.asleep.empty()) at = std::min(at, queues.asleep.top_key());
  return at;
}

Instant DispatchState::last_instant(const ReadPlan& plan, OrderIndex point, Instant until) const {
  const Group& group = plan.grouping.groups[plan.grouping.group_at[point]];
  return table_began + plan.last_acquisition(point, wire.tails[group.device], until - table_began);
}

Instant DispatchState::find_urgent(const ReadPlan& plan, GroupIndex index, Instant now) {
  GroupState& group = groups[index];
  const auto members = points_of(plan, index);
  queues.take_out(index);
  if (suspended_until[plan.grouping.groups[index].device] > now) return kNever;
  Instant due = kNever, spare = kNever, wake = kNever;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    const PointState& point = members[i];
    if (!point.wanted()) continue;
    if (point.retry_at > now) {
      wake = std::min(wake, point.retry_at);
      continue;
    }
    if (point.due < due) due = point.due, group.urgent = i;
    if ((point.eager || point.mode == Mode::kIntensive) && point.due < spare)
      spare = point.due, group.spare_urgent = i;
  }
  if (wake != kNever) queues.asleep.put(index, wake);
  if (spare != kNever) queues.spare.put(index, spare);
  return due;
}

}  // namespace fieldcast
