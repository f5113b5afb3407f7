#include "tools/cli/model/bus_plan.hpp"

#include <utility>

#include "core/model/bus_spec.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast::cli {

BusPlan make_plan(const BusSpec& bus, Duration answer_time) {
  BusPlan plan;
  plan.bus = &bus;
  plan.answer_time = answer_time;
  PointMap map = map_points(bus);
  std::vector<const Protocol*> protocols;
  for (const DeviceSpec& device : bus.devices) {
    plan.protocols.push_back(make_protocol(device, line_of(bus.port)).value());
    protocols.push_back(plan.protocols.back().get());
    for (const ChannelSpec& channel : device.channels) {
      plan.point_of.push_back(read_by_itself(channel) ? map.point_of[plan.point_of.size()]
                                                      : std::nullopt);
    }
  }
  // The schedule starts with the engine's assumption; the devices then respond after answer_time.
  plan.input = schedule_input(bus, protocols, std::move(map.points), kAssumedAnswerTime);
  for (DeviceTiming& device : plan.input.devices) device.answer_time = answer_time;
  plan.prediction = predict(plan.input, {.planner = bus.planner, .assumed = kAssumedAnswerTime});
  return plan;
}

}  // namespace fieldcast::cli
