// Input of planning: points, the line, and the devices. Plain values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/channel_kind.hpp"
#include "core/model/sample.hpp"
#include "core/plan/layout/cost.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

using PointIndex = std::uint32_t;  // in the order of ScheduleInput::points

// A range that is read for one or more channels, with their shortest refresh.
struct Point {
  DeviceIndex device = 0;
  Range range;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;  // kOnDemand: never scheduled
  int priority = 0;
  double elasticity = 1;  // its share of a stretch within its priority
};

struct ScheduleInput {
  LineFormat line;
  Duration silence{};  // after each response
  // How early a scheduled point is read before it is due; at most a tenth of its refresh.
  Duration lead = std::chrono::milliseconds{2};
  std::vector<DeviceTiming> devices;
  std::vector<Point> points;
};

}  // namespace fieldcast
