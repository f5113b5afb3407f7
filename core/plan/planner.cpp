#include "core/plan/planner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/plan/refresh.hpp"
#include "core/plan/wire_model.hpp"

namespace fieldcast {

namespace {

// Up to this planned load, reads use the largest reserve.
constexpr double kLight = 0.6;
// From this planned load on, reads use the smallest reserve.
constexpr double kCrowded = 0.95;
// Costs in a timetable are rounded to nanoseconds, and a rest lasts at least a microsecond.
constexpr Duration kRounding = std::chrono::microseconds{2};
// Share of the wire that a timetable may use.
constexpr double kMost = 0.997;

template <typename P>
std::span<const P> points_of(const Group& group, std::span<const P> points) {
  return points.subspan(group.begin, group.end - group.begin);
}

Duration base_cost_of(const ReadCost& cost, const PlannedPoint& point) {
  const Range range = cost.cover(point.first, point.end);
  return cost.of(range) - Duration{static_cast<Duration::rep>(cost.item_ns() * range.count)};
}

bool in_timetable(const PlannedPoint& point) {
  return point.wanted() && point.mode == Mode::kScheduled;
}

// Input of the timetable for a group. Without members if no point has a period.
template <typename P>
TimetableRequest request_of(const WireModel& wire, const ReadPlan& plan, const Group& group,
                            std::span<const P> points) {
  TimetableRequest request;
  request.list = group.list;
  const ReadCost& single = wire.layout.area_runs[group.area_run].cost;
  for (const PlannedPoint& point : points) {
    if (!in_timetable(point)) continue;
    TimetableMember& member = request.members.emplace_back();
    member.first = point.first;
    member.end = point.end;
    const Duration gap = allowed_gap_of(ns(point.refresh) * point.stretch, wire.lead);
    member.fits = ns(gap) / ns(plan.fastest);
    if (group.list) {
      const ListCost& list = *wire.layout.lists[group.device];
      member.area = point.area;
      member.bridge = list.bridge(point.area);
      member.range_cost = list.range_cost(point.area);
      member.item_ns = list.item_ns(point.area);
    } else {
      member.item_ns = single.item_ns();
      member.range_cost = Duration{static_cast<Duration::rep>(member.item_ns)};
    }
  }
  if (!request.members.empty()) {
    request.base_cost = group.list ? wire.layout.lists[group.device]->request_cost()
                                   : base_cost_of(single, points.front());
  }
  return request;
}

template <typename P>
void set_phases(ReadPlan& plan, const WireModel& wire, GroupIndex index,
                std::span<const P> points) {
  const Group& group = plan.grouping.groups[index];
  const TimetableRequest& request = plan.table->request(index);
  PlannedGroup& planned = plan.groups[index];
  planned.period = request.members.empty() ? Duration::zero() : request.period * plan.slot();
  planned.slack = plan.table->slack(
      index, part_of(wire.weights.margin - wire.weights.unforeseen, planned.period));
  if (!request.members.empty()) planned.load = plan.table->load(index);
  // The timetable counts until the wire is free again; points are acquired before.
  const Duration end = request.latest_end - wire.tails[group.device];
  planned.phase = request.phase * plan.slot() + end;
  auto member = request.members.begin();
  for (OrderIndex at = group.begin; at < group.end; ++at) {
    PointPlan& point = plan.points[at];
    point = {.stretch = point.stretch};
    if (!in_timetable(points[at])) continue;
    point.period = member->period * plan.slot();
    point.first_slot = member->phase;
    point.every = member->period;
    point.phase = plan.table->ends(index)[member->phase] - wire.tails[group.device];
    point.worst_gap = plan.table->longest_gap(index, *member) + planned.slack + kRounding;
    ++member;
  }
}

template <typename P>
ReadPlan with_all_phases(ReadPlan plan, const WireModel& wire, std::span<const P> points) {
  if (!plan.table) return plan;
  for (GroupIndex index = 0; index < plan.groups.size(); ++index)
    set_phases(plan, wire, index, points);
  return plan;
}

class PlanMaker {
 public:
  PlanMaker(PlanBasis basis, Grouping grouping)
      : basis_(std::move(basis)), wire_(basis_.wire), load_(wire_) {
    plan_.order = wire_.layout.point_at;
    plan_.grouping = std::move(grouping);
    plan_.groups.resize(plan_.grouping.groups.size());
    plan_.points.resize(basis_.points.size());
  }
  PlanMaker(const PlanBasis& basis, const ReadPlan& plan)
      : basis_(basis), wire_(basis_.wire), load_(wire_), plan_(plan) {}

  [[nodiscard]] std::vector<ReadPlan> make() {
    stretch_to(1);
    find_load();
    const double factor = enough_stretch();
    if (factor > 1) stretch_to(factor);
    std::vector<Timetable> others;
    if (wire_.rules.timetable) others = fit(factor);
    std::vector<ReadPlan> plans{finished(std::move(plan_))};
    for (Timetable& table : others) {
      ReadPlan other = plans.front();
      other.table = std::move(table);
      plans.push_back(with_all_phases(std::move(other), wire_, points()));
    }
    return plans;
  }

  [[nodiscard]] double total_load(bool stretched) {
    double sum = 0;
    for (GroupIndex index = 0; index < plan_.groups.size(); ++index) {
      plan_.groups[index].load = load_of_group(index, stretched);
      sum += plan_.groups[index].load;
    }
    return sum;
  }

 private:
  [[nodiscard]] double load_of_group(GroupIndex index, bool stretched) {
    const Group& group = plan_.grouping.groups[index];
    const Duration period = basis_.periods.empty() ? Duration::zero() : basis_.periods[index];
    return load_.of(group, points_of(group, points()),
                    {period, plan_.fastest, plan_.margin, stretched});
  }

  void stretch_to(double factor) {
    stretched_ = stretch_points(basis_.points, factor);
    plan_.stretch = stretched_.greatest;
    plan_.fastest = fastest_of(basis_.points, wire_.lead);
  }

  void find_load_with(double lightness) {
    plan_.lightness = lightness;
    find_load_at(wire_.weights.margin + lightness * wire_.weights.light_reserve);
  }
  void find_load_at(double margin) {
    plan_.margin = margin;
    plan_.load = total_load(false);
    plan_.demand = plan_.load * basis_.overrun;
  }
  // The margin depends on the load: a wire that has no time for it gets a smaller one. If the least
  // one is too much, refreshes are stretched, with the usual margin.
  void find_load() {
    find_load_with(1);
    if (plan_.load <= kLight || !wire_.rules.timetable) return;
    find_load_with(0);
    const double lightness = std::clamp((kCrowded - plan_.load) / (kCrowded - kLight), 0.0, 1.0);
    if (lightness > 0) find_load_with(lightness);
    if (plan_.demand <= kMost) return;
    find_load_at(margin_for(plan_.demand));
    if (plan_.demand > kFullLoad) find_load_with(0);
  }
  // `needed`: share of the wire at the present margin.
  [[nodiscard]] double margin_for(double needed) const {
    return std::max(wire_.weights.least_margin, 1 - (1 - plan_.margin) * needed / kMost);
  }

  [[nodiscard]] double enough_stretch() {
    if (plan_.demand <= kFullLoad) return 1;
    double enough = plan_.demand / kFullLoad;
    if (stretched_.priorities <= 1 && !stretched_.uneven) return enough;
    double fails = stretched_.uneven ? 1 : enough;
    if (stretched_.uneven) enough = 1 + (enough - 1) / stretched_.least_elasticity;
    enough *= kMostApart;
    for (int halving = 0; halving < 14; ++halving) {
      const double middle = std::sqrt(fails * enough);
      stretch_to(middle);
      (total_load(true) * basis_.overrun > kFullLoad ? fails : enough) = middle;
    }
    return enough;
  }

  // Whole slots need more wire time than the requested refreshes; if it is too much, the margin is
  // smaller, or all refreshes are stretched slightly more.
  [[nodiscard]] std::vector<Timetable> fit(double factor) {
    constexpr int kAttempts = 8;
    constexpr double kClose = 1e-4;
    std::vector<Timetable> others;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      others = make_timetable();
      if (plan_.table->load() * basis_.overrun > kMost && factor <= 1) {
        plan_.margin = margin_for(plan_.table->load() * basis_.overrun);
        plan_.table->set_period(base_period());
        for (Timetable& other : others) other.set_period(base_period());
      }
      double requested = 0;
      for (GroupIndex index = 0; index < plan_.groups.size(); ++index) {
        if (!plan_.table->request(index).members.empty()) requested += load_of_group(index, true);
      }
      if (requested > 0) plan_.fit = plan_.table->load() / requested;
      const double needed = plan_.table->load() * basis_.overrun;
      if (needed <= kMost + kClose) break;
      plan_.margin = std::max(plan_.margin, wire_.weights.margin);
      factor *= 1.002 * needed / kMost;
      stretch_to(factor);
    }
    return others;
  }

  [[nodiscard]] Duration base_period() const {
    return std::max(Duration{1}, cycle_period(plan_.fastest, plan_.fastest, plan_.margin));
  }

  [[nodiscard]] std::vector<Timetable> make_timetable() {
    constexpr std::size_t kMany = 2000;  // number of points above which each is placed only once
    plan_.table.emplace(TableTiming{base_period(), plan_.fastest, wire_.weights.unforeseen});
    std::vector<TimetableRequest> requests;
    for (const Group& group : plan_.grouping.groups)
      requests.push_back(request_of(wire_, plan_, group, points_of(group, points())));
    return plan_.table->fill(std::move(requests),
                             basis_.points.size() > kMany ? 0 : wire_.weights.rounds,
                             wire_.weights.search && plan_.stretch <= 1);
  }

  [[nodiscard]] ReadPlan finished(ReadPlan plan) const {
    for (OrderIndex index = 0; index < plan.points.size(); ++index)
      plan.points[index].stretch = basis_.points[index].stretch;
    return with_all_phases(std::move(plan), wire_, points());
  }
  [[nodiscard]] std::span<const PlannedPoint> points() const { return basis_.points; }

  PlanBasis basis_;
  const WireModel& wire_;
  GroupLoad load_;
  ReadPlan plan_;
  Stretched stretched_;
};

}  // namespace

Grouping group_points(const PlanBasis& basis) {
  const PlanRules& rules = basis.wire.rules;
  std::vector<Wanted> wanted;
  std::vector<double> rates;
  for (const PlannedPoint& point : basis.points) {
    wanted.push_back({point.first, point.end, rules.grouping == GroupingRule::kSinglePoints});
    if (rules.timetable) rates.push_back(1 / std::max(1e-9, to_seconds(point.refresh)));
  }
  return make_groups(basis.wire.layout, wanted, rates);
}

std::vector<ReadPlan> make_plans(PlanBasis basis, Grouping grouping) {
  return PlanMaker(std::move(basis), std::move(grouping)).make();
}

double load_of(const PlanBasis& basis, const ReadPlan& plan) {
  return PlanMaker(basis, plan).total_load(false);
}

Duration fastest_of(std::span<const PlannedPoint> points, Duration lead) {
  Duration fastest = Duration::max();
  for (const PlannedPoint& point : points) {
    if (in_timetable(point))
      fastest = std::min(fastest, allowed_gap_of(ns(point.refresh) * point.stretch, lead));
  }
  return fastest == Duration::max() ? Duration{1} : fastest;
}

ReadPlan amended(ReadPlan plan, const WireModel& wire, std::span<const PointState> points,
                 std::span<const GroupIndex> changed) {
  if (!plan.table) return plan;
  for (const GroupIndex index : changed) {
    const Group& group = plan.grouping.groups[index];
    plan.table->change(index, request_of(wire, plan, group, points_of(group, points)));
  }
  plan.table->align();
  return with_all_phases(std::move(plan), wire, points);
}

PlannedLoad planned_load_of(const ScheduleInput& input, Planner planner) {
  const WireModel wire(input, planner);
  PlanBasis basis{wire, planned_points(input, wire.layout)};
  Grouping grouping = group_points(basis);
  const ReadPlan plan = std::move(make_plans(std::move(basis), std::move(grouping)).front());
  return {plan.planned_load(), plan.stretch};
}

}  // namespace fieldcast
