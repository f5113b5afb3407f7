#include "core/schedule/bus_schedule.hpp"

#include <cassert>

namespace fieldcast {
namespace {
constexpr double kLightLoad = 0.5;
// Lead of a lightly loaded bus, limited to a tenth of a refresh.
constexpr Duration kEarlyLead = std::chrono::milliseconds{60};
}  // namespace

Duration silence_for(const BusSpec& bus) {
  if (!has_line(bus.port) && !std::holds_alternative<Duration>(bus.silence))
    return Duration::zero();
  return silence_of(bus.silence, line_of(bus.port));
}

ScheduleInput wire_input(const BusSpec& bus, std::span<const Protocol* const> protocols,
                         std::vector<Point> points, Duration answer_time) {
  assert(protocols.size() == bus.devices.size());
  ScheduleInput input;
  input.line = line_of(bus.port);
  input.silence = silence_for(bus);
  input.points = std::move(points);
  for (std::size_t i = 0; i < protocols.size(); ++i) {
    const DeviceSpec& device = bus.devices[i];
    input.devices.push_back(
        {protocols[i], answer_time, device.pause, device.max_block, device.max_gap});
  }
  return input;
}

ScheduleInput schedule_input(const BusSpec& bus, std::span<const Protocol* const> protocols,
                             std::vector<Point> points, Duration answer_time) {
  ScheduleInput input = wire_input(bus, protocols, std::move(points), answer_time);
  if (planned_load_of(input, bus.planner).load <= kLightLoad) input.lead = kEarlyLead;
  return input;
}

}  // namespace fieldcast
