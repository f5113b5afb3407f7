// Input of the scheduler, shared by the bus engine, `fieldcast plan` and the simulation, so that
// predictions match the execution. Pure functions.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

// Initial value: from the end of a request to the first byte of the response.
inline constexpr Duration kAssumedResponseTime = std::chrono::milliseconds{5};

// The line of a serial server needs it, a plain TCP device does not.
[[nodiscard]] Duration silence_for(const BusSpec& bus);

// Uses the shortest lead. `protocols`: one per device; must outlive the input.
[[nodiscard]] ScheduleInput wire_input(const BusSpec& bus,
                                       std::span<const Protocol* const> protocols,
                                       std::vector<Point> points, Duration response_time);

// A lightly loaded bus gets a longer lead, to repeat a failed read in time.
[[nodiscard]] ScheduleInput schedule_input(const BusSpec& bus,
                                           std::span<const Protocol* const> protocols,
                                           std::vector<Point> points, Duration response_time);

// Points of the channels of a bus: channels on the same items of a device share one.
struct PointMap {
  std::vector<Point> points;  // kOnDemand if no channel is read periodically
  std::vector<std::vector<ChannelIndex>> channels_of;  // by point
  // By channel of the bus; empty for write-only ones and those that are never requested.
  std::vector<std::optional<PointIndex>> point_of;
};

[[nodiscard]] PointMap map_points(const BusSpec& bus);

void ask_for(Point& point, const ChannelSpec& channel, std::optional<Duration> refresh);

}  // namespace fieldcast
