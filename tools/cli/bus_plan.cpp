#include "tools/cli/bus_plan.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/model/make_protocol.hpp"

namespace fieldcast::cli {
namespace {

bool read_by_itself(const ChannelSpec& channel) {
  return channel.access != Access::kWriteOnly && channel.mode != Mode::kOnDemand && !channel.on_interest;
}

// One point for each range, as urgent as the most urgent of its channels.
class PointMaker {
 public:
  explicit PointMaker(std::vector<Point>& points) : points_(points) {}

  PointIndex point_for(DeviceIndex device, const ChannelSpec& channel) {
    const auto key = std::make_tuple(device, channel.range.area, channel.range.first, channel.range.count);
    const auto [at, is_new] = known_.emplace(key, static_cast<PointIndex>(points_.size()));
    if (is_new) {
      points_.push_back({device, channel.range, channel.refresh, channel.mode, channel.priority});
      return at->second;
    }
    auto& point = points_[at->second];
    point.refresh = std::min(point.refresh, channel.refresh);
    point.priority = std::max(point.priority, channel.priority);
    if (channel.mode == Mode::kIntensive) point.mode = Mode::kIntensive;
    return at->second;
  }

 private:
  std::vector<Point>& points_;
  std::map<std::tuple<DeviceIndex, AreaIndex, std::uint32_t, std::uint32_t>, PointIndex> known_;
};

}  // namespace

BusPlan make_plan(const BusSpec& bus, Duration answer_time) {
  BusPlan plan;
  plan.bus = &bus;
  plan.answer_time = answer_time;
  plan.input.line = line_of(bus.port);
  plan.input.silence = silence_of(bus.silence, plan.input.line);
  PointMaker maker(plan.input.points);
  for (DeviceIndex d = 0; d < bus.devices.size(); ++d) {
    const auto& device = bus.devices[d];
    plan.protocols.push_back(make_protocol(device, plan.input.line).value());
    plan.input.devices.push_back({plan.protocols.back().get(), answer_time, device.pause, device.max_block, device.max_gap});
    for (const auto& channel : device.channels) {
      plan.point_of.push_back(read_by_itself(channel) ? std::optional{maker.point_for(d, channel)} : std::nullopt);
    }
  }
  plan.prediction = predict(plan.input);
  return plan;
}

}  // namespace fieldcast::cli
