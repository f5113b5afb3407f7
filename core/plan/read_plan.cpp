#include "core/plan/read_plan.hpp"

namespace fieldcast {

namespace {

std::string percent(double share) {
  const auto tenths = static_cast<long long>(share * 1000 + 0.5);
  return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) + " %";
}

std::string cycle_text(Duration period, Duration phase) {
  if (period == Duration::zero()) return "no period";
  return "every " + to_text(period) + " at " + to_text(phase);
}

}  // namespace

std::string to_text(const ReadPlan& plan) {
  std::string text = "load " + percent(plan.planned_load());
  if (plan.table)
    text += ", slots of " + to_text(plan.slot()) + ", hyperperiod " + to_text(plan.hyperperiod());
  if (plan.stretch > 1) text += ", refreshes up to " + percent(plan.stretch) + " as long";
  text += '\n';
  for (GroupIndex index = 0; index < plan.groups.size(); ++index) {
    const Group& group = plan.grouping.groups[index];
    const PlannedGroup& planned = plan.groups[index];
    text += "group " + std::to_string(index) + " of device " + std::to_string(group.device) + ", " +
            percent(planned.load) + ": " + cycle_text(planned.period, planned.phase) + '\n';
    for (OrderIndex at = group.begin; at < group.end; ++at) {
      const PointPlan& point = plan.points[at];
      text += "  point " + std::to_string(plan.order[at]) + ": " +
              cycle_text(point.period, point.phase);
      if (point.worst_gap) text += ", at most " + to_text(*point.worst_gap) + " apart";
      text += '\n';
    }
  }
  return text;
}

}  // namespace fieldcast
