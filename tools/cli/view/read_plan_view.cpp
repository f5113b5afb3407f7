#include "tools/cli/view/read_plan_view.hpp"

#include <string>
#include <vector>

namespace fieldcast::cli {
namespace {

// Names of the channels of each point.
std::vector<std::vector<std::string>> channels_by_point(const BusPlan& plan) {
  std::vector<std::vector<std::string>> names(plan.input.points.size());
  std::size_t index = 0;
  for (const DeviceSpec& device : plan.bus->devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (const auto point = plan.point_of[index++]) names[*point].push_back(channel.name);
    }
  }
  return names;
}

// Null if `period` is none.
Json in_cycle(Duration period, Duration time) {
  return period == Duration::zero() ? Json() : Json(time.count());
}

}  // namespace

Json read_plan_json(const BusPlan& bus) {
  const ReadPlan& plan = bus.prediction.plan;
  const auto names = channels_by_point(bus);
  Json json{{"load", plan.planned_load()},
            {"stretch", plan.stretch},
            {"slot", in_cycle(plan.slot(), plan.slot())},
            {"hyperperiod", in_cycle(plan.slot(), plan.hyperperiod())},
            {"groups", Json::array()}};
  for (GroupIndex index = 0; index < plan.groups.size(); ++index) {
    const Group& group = plan.grouping.groups[index];
    const PlannedGroup& planned = plan.groups[index];
    auto points = Json::array();
    for (OrderIndex at = group.begin; at < group.end; ++at) {
      const Range& range = bus.input.points[plan.order[at]].range;
      const PointPlan& point = plan.points[at];
      points.push_back({{"area", bus.protocols[group.device]->areas()[range.area].name},
                        {"first", range.first},
                        {"count", range.count},
                        {"channels", names[plan.order[at]]},
                        {"period", in_cycle(point.period, point.period)},
                        {"phase", in_cycle(point.period, point.phase)},
                        {"worst_gap", point.worst_gap ? Json(point.worst_gap->count()) : Json()},
                        {"stretch", point.stretch}});
    }
    json["groups"].push_back({{"device", bus.bus->devices[group.device].name},
                              {"list", group.list},
                              {"period", in_cycle(planned.period, planned.period)},
                              {"phase", in_cycle(planned.period, planned.phase)},
                              {"slack", in_cycle(planned.period, planned.slack)},
                              {"load", planned.load},
                              {"points", std::move(points)}});
  }
  return json;
}

}  // namespace fieldcast::cli
