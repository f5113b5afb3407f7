#include "core/plan/wire_model.hpp"

#include <algorithm>

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

std::vector<PlannedPoint> planned_points(const ScheduleInput& input, const Layout& layout) {
  std::vector<PlannedPoint> points(input.points.size());
  for (OrderIndex index = 0; index < points.size(); ++index) {
    const Point& from = input.points[layout.point_at[index]];
    PlannedPoint& point = points[index];
    point.first = from.range.first;
    point.end = from.range.end();
    point.area = from.range.area;
    point.mode = from.mode;
    point.priority = static_cast<std::int8_t>(std::clamp(from.priority, -100, 100));
    point.elasticity = static_cast<float>(std::clamp(from.elasticity, 0.1, 10.0));
    const ReadCost& cost = layout.area_runs[layout.area_run_at[index]].cost;
    const auto alone = cost.of_single(cost.cover(point.first, point.end));
    point.readable = alone.has_value();
    point.least_refresh = std::max(Duration{1}, alone.value_or(Duration{1}));
    point.refresh = std::max(point.least_refresh, from.refresh);
  }
  return points;
}

std::vector<std::uint32_t> bridges_of(const Layout& layout) {
  std::vector<std::uint32_t> bridges;
  for (const AreaRun& run : layout.area_runs) bridges.push_back(run.cost.bridge());
  return bridges;
}

}  // namespace fieldcast
