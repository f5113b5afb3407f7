#include <algorithm>
#include <utility>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

namespace {

void drop_repeated(std::vector<GroupIndex>& groups) {
  std::ranges::sort(groups);
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
}

}  // namespace

void PlanRunner::set_allowed_gap(PointState& point) const {
  const Duration before = point.allowed_gap;
  point.allowed_gap = allowed_gap_of(ns(point.refresh) * point.stretch, state_.wire.lead);
  if (point.due == kNever) return;
  point.due += point.allowed_gap - before;
  point.deadline += point.allowed_gap - before;
}

void PlanRunner::set_point(PointIndex of, const Point& wanted, Instant now) {
  const OrderIndex index = index_of(of);
  PointState& point = state_.points[index];
  const bool was_wanted = point.wanted();
  forget_decisions();
  require(point, wanted);
  set_allowed_gap(point);
  if (begun_ && !was_wanted) {
    point.due = point.deadline = later(now, point.allowed_gap);
    point.eager = true;
  }
  touch(index);
}

bool PlanRunner::set_response_time(DeviceIndex device, AreaIndex area, Duration response_time) {
  // A list contains ranges of several areas; the last learned time applies to all.
  if (auto& list = state_.wire.layout.lists[device]) list->set_response_time(response_time);
  return touch_area(device, area, state_.wire.change_cost(device, area, [&](ReadCost& cost) {
    cost.set_response_time(response_time);
  }));
}

bool PlanRunner::set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items) {
  forget_decisions();
  return touch_area(device, area, state_.wire.change_cost(device, area, [&](ReadCost& cost) {
    cost.set_longest(items);
  }));
}

bool PlanRunner::touch_area(DeviceIndex device, AreaIndex area, bool is_read) {
  if (!is_read) return false;
  for (const GroupIndex index : plan_.grouping.groups_of[device]) {
    const Group& group = plan_.grouping.groups[index];
    if (group.list || state_.wire.layout.area_runs[group.area_run].area == area) touch(group.begin);
  }
  return true;
}

void PlanRunner::touch(OrderIndex index) {
  changed_.push_back(plan_.grouping.group_at[index]);
  if (remembered_) remembered_->push_back(index);
}

void PlanRunner::set_plan(ReadPlan plan) {
  plan_ = std::move(plan);
  if (plan_.table) dispatcher_ = make_dispatcher(state_.wire.planner, plan_);
}

// Changed groups get phases in the present timetable; due times are kept.
void PlanRunner::settle_changes(Instant now) {
  drop_repeated(changed_);
  set_plan(amended(std::move(plan_), state_.wire, state_.points, changed_));
  for (const GroupIndex group : changed_) take_phases(group);
  for (const GroupIndex group : changed_) refresh(group, now);
  changed_.clear();
}

void PlanRunner::take_phases(GroupIndex index) {
  const PlannedGroup& planned = plan_.groups[index];
  const bool timed = planned.period != Duration::zero();
  state_.groups[index].cycle =
      timed ? Cycle{state_.table_began + planned.phase, planned.period} : Cycle{};
  // Without a cycle no point has a period, for example when the last one becomes intensive.
  const Group& group = plan_.grouping.groups[index];
  for (OrderIndex at = group.begin; at < group.end; ++at)
    state_.points[at].period = plan_.points[at].period;
}

void PlanRunner::adopt(ReadPlan plan, Instant began, Instant now) {
  const bool regrouped = plan.grouping != plan_.grouping;
  changed_.clear();
  for (const OrderIndex index : remembered_.value_or(std::vector<OrderIndex>{}))
    changed_.push_back(plan.grouping.group_at[index]);
  set_plan(std::move(plan));
  if (regrouped) {
    state_.groups.assign(plan_.groups.size(), {});
    state_.queues = GroupQueues(plan_.groups.size());
    forget_decisions();
  }
  for (OrderIndex index = 0; index < state_.points.size(); ++index) {
    state_.points[index].stretch = plan_.points[index].stretch;
    set_allowed_gap(state_.points[index]);
  }
  if (!begun_) return;
  if (!changed_.empty()) {
    drop_repeated(changed_);
    set_plan(amended(std::move(plan_), state_.wire, state_.points, changed_));
    changed_.clear();
  }
  state_.table_began = began;
  for (GroupIndex group = 0; group < state_.groups.size(); ++group) take_phases(group);
  watch_.plan_began(later(now, plan_.hyperperiod()));
  find_instants(now);
  refresh_all(now);
}

// Points are due at the last of their instants within the allowed gap; at the first one if never
// read.
void PlanRunner::find_instants(Instant now) {
  for (OrderIndex index = 0; index < state_.points.size(); ++index) {
    PointState& point = state_.points[index];
    const bool searched =
        point.bad || point.suspect || (point.eager && point.retry_at != Instant{});
    if (!point.wanted() || point.period == Duration::zero() || point.due == kNever || searched)
      continue;
    const Instant next = later(now, point.period);
    point.due = state_.last_instant(plan_, index,
                                    point.eager ? std::min(point.deadline, next) : point.deadline);
  }
}

PlanBasis PlanRunner::basis() const {
  PlanBasis basis{state_.wire, {state_.points.begin(), state_.points.end()}, watch_.overrun(), {}};
  for (const GroupState& group : state_.groups) basis.periods.push_back(group.cycle.period);
  return basis;
}

}  // namespace fieldcast
