#include "core/schedule/bus_schedule.hpp"

#include <algorithm>
#include <cassert>
#include <map>
#include <tuple>

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
                         std::vector<Point> points, Duration response_time) {
  assert(protocols.size() == bus.devices.size());
  ScheduleInput input;
  input.line = line_of(bus.port);
  input.silence = silence_for(bus);
  input.points = std::move(points);
  for (std::size_t i = 0; i < protocols.size(); ++i) {
    const DeviceSpec& device = bus.devices[i];
    input.devices.push_back({protocols[i], response_time, device.pause, device.max_block,
                             device.max_gap, bus.in_flight});
  }
  return input;
}

ScheduleInput schedule_input(const BusSpec& bus, std::span<const Protocol* const> protocols,
                             std::vector<Point> points, Duration response_time) {
  ScheduleInput input = wire_input(bus, protocols, std::move(points), response_time);
  if (planned_load_of(input, bus.planner).load <= kLightLoad) input.lead = kEarlyLead;
  return input;
}

PointMap map_points(const BusSpec& bus) {
  PointMap map;
  std::map<std::tuple<DeviceIndex, AreaIndex, std::uint32_t, std::uint32_t>, PointIndex> known;
  ChannelIndex index = 0;
  for (DeviceIndex device = 0; device < bus.devices.size(); ++device) {
    for (const ChannelSpec& channel : bus.devices[device].channels) {
      map.point_of.emplace_back();
      if (is_requestable(channel)) {
        const auto key =
            std::make_tuple(device, channel.range.area, channel.range.first, channel.range.count);
        const auto [at, is_new] = known.emplace(key, static_cast<PointIndex>(map.points.size()));
        if (is_new) {
          map.points.push_back({device, channel.range, channel.refresh, Mode::kOnDemand,
                                channel.priority, channel.elasticity});
          map.channels_of.emplace_back();
        }
        ask_for(map.points[at->second], channel,
                read_by_itself(channel) ? std::optional(channel.refresh) : std::nullopt);
        map.channels_of[at->second].push_back(index);
        map.point_of.back() = at->second;
      }
      ++index;
    }
  }
  return map;
}

void ask_for(Point& point, const ChannelSpec& channel, std::optional<Duration> refresh) {
  if (!refresh) return;
  const bool first = point.mode == Mode::kOnDemand;
  point.refresh = first ? *refresh : std::min(point.refresh, *refresh);
  point.priority = first ? channel.priority : std::max(point.priority, channel.priority);
  point.elasticity = first ? channel.elasticity : std::min(point.elasticity, channel.elasticity);
  if (first || channel.mode == Mode::kIntensive)
    point.mode = channel.mode == Mode::kIntensive ? Mode::kIntensive : Mode::kScheduled;
}

}  // namespace fieldcast
