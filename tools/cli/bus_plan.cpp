#include "tools/cli/bus_plan.hpp"

#include <utility>

#include "core/model/make_protocol.hpp"
#include "core/schedule/point_map.hpp"

namespace fieldcast::cli {

BusPlan make_plan(const BusSpec& bus, Duration answer_time) {
  BusPlan plan;
  plan.bus = &bus;
  plan.answer_time = answer_time;
  plan.input.line = line_of(bus.port);
  plan.input.silence = silence_of(bus.silence, plan.input.line);
  PointMap map = map_points(bus);
  plan.input.points = std::move(map.points);
  for (const DeviceSpec& device : bus.devices) {
    plan.protocols.push_back(make_protocol(device, plan.input.line).value());
    plan.input.devices.push_back({plan.protocols.back().get(), answer_time, device.pause, device.max_block, device.max_gap});
    for (const ChannelSpec& channel : device.channels) {
      plan.point_of.push_back(read_by_itself(channel) ? map.point_of[plan.point_of.size()] : std::nullopt);
    }
  }
  plan.prediction = predict(plan.input);
  return plan;
}

}  // namespace fieldcast::cli
