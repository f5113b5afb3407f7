// Points of the channels of a bus: channels on the same items of a device share one.
#pragma once

#include <optional>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

struct PointMap {
  std::vector<Point> points;  // kOnDemand if no channel is read periodically
  std::vector<std::vector<ChannelIndex>> channels_of;  // by point
  // By channel of the bus; empty for write-only ones.
  std::vector<std::optional<PointIndex>> point_of;
};

[[nodiscard]] PointMap map_points(const BusSpec& bus);

void ask_for(Point& point, const ChannelSpec& channel, std::optional<Duration> refresh);

}  // namespace fieldcast
