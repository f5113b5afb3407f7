#include "core/plan/read_plan.hpp"

namespace fieldcast {

namespace {

PlanReport::Point report_of(const PointPlan& plan, const Point& point, std::string_view area,
                            std::vector<std::string> channels) {
  const bool timed = plan.period != Duration::zero();
  return {.area = std::string(area),
          .first = point.range.first,
          .count = point.range.count,
          .channels = std::move(channels),
          .period = plan.period,
          .phase = timed ? plan.phase : Duration::zero(),
          .worst_gap = plan.worst_gap,
          .stretch = plan.stretch};
}

}  // namespace

PlanReport report_of(const ReadPlan& plan, const std::vector<Point>& points,
                     const PlanNames& names) {
  PlanReport report{.load = plan.planned_load(),
                    .stretch = plan.stretch,
                    .slot = plan.slot(),
                    .hyperperiod = plan.hyperperiod()};
  for (GroupIndex index = 0; index < plan.groups.size(); ++index) {
    const Group& group = plan.grouping.groups[index];
    const PlannedGroup& planned = plan.groups[index];
    const bool timed = planned.period != Duration::zero();
    PlanReport::Group& out = report.groups.emplace_back();
    out.device = names.device(group.device);
    out.list = group.list;
    out.period = planned.period;
    out.phase = timed ? planned.phase : Duration::zero();
    out.slack = timed ? planned.slack : Duration::zero();
    out.load = planned.load;
    for (OrderIndex at = group.begin; at < group.end; ++at) {
      const PointIndex point = plan.order[at];
      out.points.push_back(report_of(plan.points[at], points[point],
                                     names.area(group.device, points[point].range.area),
                                     names.channels(point)));
    }
  }
  return report;
}

}  // namespace fieldcast
