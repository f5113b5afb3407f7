// Which points the channels of a bus need: channels on the same items of a device share one. The
// bus engine reads by it, and `fieldcast plan` predicts by it.
#pragma once

#include <optional>
#include <vector>

#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

struct PointMap {
  std::vector<Point> points;  // kOnDemand: of channels that are not read by themselves
  std::vector<std::vector<ChannelIndex>> channels_of;  // of each point
  // Of each channel of the bus; nothing for write-only ones.
  std::vector<std::optional<PointIndex>> point_of;
};

[[nodiscard]] PointMap map_points(const BusSpec& bus);

// Makes the point at least as urgent as this channel wants it. Without a refresh nothing changes.
void ask_for(Point& point, const ChannelSpec& channel, std::optional<Duration> refresh);

}  // namespace fieldcast
