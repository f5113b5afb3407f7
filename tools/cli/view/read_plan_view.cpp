#include "tools/cli/view/read_plan_view.hpp"

#include <string>
#include <vector>

namespace fieldcast::cli {
namespace {

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

// Null if `period` is zero.
Json in_cycle(Duration period, Duration time) {
  return period == Duration::zero() ? Json() : Json(time.count());
}

Json to_json(const PlanReport::Point& point) {
  return {{"area", point.area},
          {"first", point.first},
          {"count", point.count},
          {"channels", point.channels},
          {"period", in_cycle(point.period, point.period)},
          {"phase", in_cycle(point.period, point.phase)},
          {"worst_gap", point.worst_gap ? Json(point.worst_gap->count()) : Json()},
          {"stretch", point.stretch}};
}

Json to_json(const PlanReport::Group& group) {
  auto points = Json::array();
  for (const PlanReport::Point& point : group.points) points.push_back(to_json(point));
  return {{"device", group.device},
          {"list", group.list},
          {"period", in_cycle(group.period, group.period)},
          {"phase", in_cycle(group.period, group.phase)},
          {"slack", in_cycle(group.period, group.slack)},
          {"load", group.load},
          {"points", points}};
}

}  // namespace

Json read_plan_json(const PlanReport& plan) {
  auto groups = Json::array();
  for (const PlanReport::Group& group : plan.groups) groups.push_back(to_json(group));
  return {{"load", plan.load},
          {"stretch", plan.stretch},
          {"slot", in_cycle(plan.slot, plan.slot)},
          {"hyperperiod", in_cycle(plan.slot, plan.hyperperiod)},
          {"groups", groups}};
}

Json read_plan_json(const BusPlan& bus) {
  const auto channels = channels_by_point(bus);
  return read_plan_json(
      report_of(bus.prediction.plan, bus.input.points,
                {.device = [&](DeviceIndex device) -> std::string_view {
                   return bus.bus->devices[device].name;
                 },
                 .area = [&](DeviceIndex device, AreaIndex area) -> std::string_view {
                   return bus.protocols[device]->areas()[area].name;
                 },
                 .channels = [&](PointIndex point) { return channels[point]; }}));
}

}  // namespace fieldcast::cli
