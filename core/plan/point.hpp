// What a bus is asked to read: points, the line that carries them, and the devices that answer.
// Plain values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/plan/cost.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

using PointIndex = std::uint32_t;  // in the order of ScheduleInput::points

// One distinct range that is read for one or more channels. Its refresh is the shortest of theirs.
struct Point {
  DeviceIndex device = 0;
  Range range;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;  // kOnDemand: never scheduled
  int priority = 0;
  double elasticity = 1;  // its share of a stretch beside the other points of its priority
};

struct ScheduleInput {
  LineFormat line;
  Duration silence{};  // after each answer
  // How early a scheduled point is read before it is due. At most a tenth of its refresh counts.
  Duration lead = std::chrono::milliseconds{2};
  std::vector<DeviceTiming> devices;
  std::vector<Point> points;
};

}  // namespace fieldcast
