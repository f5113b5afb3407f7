#include "core/plan/wire_model.hpp"

#include <algorithm>

#include "core/plan/refresh.hpp"

namespace fieldcast {

PlanRules rules_of(Planner planner) {
  switch (planner) {
    case Planner::kCyclic: break;
    case Planner::kDynamicBlocks: return {GroupingRule::kSingleRanges, ShapeRule::kNear, false};
    case Planner::kOnePerChannel: return {GroupingRule::kSinglePoints, ShapeRule::kSingle, false};
    case Planner::kFastestMember: return {GroupingRule::kSingleRanges, ShapeRule::kWhole, false};
  }
  return {GroupingRule::kLists, ShapeRule::kCyclic, true};
}

WireModel::WireModel(const ScheduleInput& input, Planner of_bus, const CyclicWeights& with)
    : planner(of_bus),
      rules(rules_of(of_bus)),
      weights(with),
      lead(input.lead),
      silence(input.silence),
      layout(make_layout(input, rules.grouping)) {
  for (const DeviceTiming& device : input.devices) tails.push_back(input.silence + device.pause);
}

void require(PlannedPoint& point, const Point& wanted) {
  point.mode = wanted.mode;
  point.refresh = std::max(point.least_refresh, wanted.refresh);
  point.priority = static_cast<std::int8_t>(std::clamp(wanted.priority, -100, 100));
  point.elasticity = static_cast<float>(std::clamp(wanted.elasticity, 0.1, 10.0));
}

std::vector<PlannedPoint> planned_points(const ScheduleInput& input, const Layout& layout) {
  std::vector<PlannedPoint> points(input.points.size());
  for (OrderIndex index = 0; index < points.size(); ++index) {
    const Point& from = input.points[layout.point_at[index]];
    PlannedPoint& point = points[index];
    point.first = from.range.first;
    point.end = from.range.end();
    point.area = from.range.area;
    const ReadCost& cost = layout.area_runs[layout.area_run_at[index]].cost;
    const auto alone = cost.of_single(cost.cover(point.first, point.end));
    point.readable = alone.has_value();
    point.least_refresh = std::max(Duration{1}, alone.value_or(Duration{1}));
    require(point, from);
  }
  return points;
}

std::vector<std::uint32_t> bridges_of(const Layout& layout) {
  std::vector<std::uint32_t> bridges;
  for (const AreaRun& run : layout.area_runs) bridges.push_back(run.cost.bridge());
  return bridges;
}

void GroupLoad::imagine(std::span<const PlannedPoint> points, bool stretched) {
  imagined_.clear();
  for (const PlannedPoint& planned : points) {
    PointState& point = imagined_.emplace_back(PointState{planned});
    const double refresh = ns(point.refresh) * (stretched ? point.stretch : 1.0);
    point.allowed_gap = allowed_gap_of(refresh, wire_.lead);
    point.due = point.deadline = Instant{point.allowed_gap};
  }
}

std::uint32_t GroupLoad::most_urgent() const {
  std::uint32_t urgent = 0;
  for (std::uint32_t i = 0; i < imagined_.size(); ++i) {
    const bool sooner = !imagined_[urgent].wanted() || imagined_[i].due < imagined_[urgent].due;
    if (imagined_[i].wanted() && sooner) urgent = i;
  }
  return urgent;
}

double GroupLoad::of(const Group& group, std::span<const PlannedPoint> points, const Terms& terms) {
  constexpr int kReads = 64;
  imagine(points, terms.stretched);
  Duration longest{}, shortest = Duration::max();
  for (const PointState& point : imagined_) {
    if (!point.wanted()) continue;
    longest = std::max(longest, point.allowed_gap);
    shortest = std::min(shortest, point.allowed_gap);
  }
  if (longest == Duration::zero()) return 0;
  Cycle cycle;
  if (wire_.rules.timetable) cycle.period = cycle_period(shortest, terms.fastest, terms.margin);
  Instant now{};
  Duration spent{};
  for (int reads = 0; reads < kReads && now <= Instant{2 * longest}; ++reads) {
    const std::uint32_t urgent = most_urgent();
    now = imagined_[urgent].due;
    const Selection& read = selector_.select(wire_.layout, group, imagined_, urgent, now,
                                             {Duration::zero(), terms.period});
    spent += read.cost;
    for (const std::uint32_t i : read.members)
      imagined_[i].due = due_after(cycle, now, imagined_[i].allowed_gap);
  }
  return ns(spent) / ns(now.time_since_epoch());
}

}  // namespace fieldcast
