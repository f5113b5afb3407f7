// What a dispatcher decides: one read, or a rest. Plain values.
#pragma once

#include <variant>
#include <vector>

#include "core/plan/point.hpp"

namespace fieldcast {

// One read: the ranges for one request (one, for protocols without range lists) and the points
// whose data it brings.
struct Block {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::vector<PointIndex> points;
  Duration cost{};  // of the wire: request, answer, answer time, silence, pause
};

// Nothing is worth reading before then.
struct Rest {
  Instant until = kNever;
};

using Decision = std::variant<Block, Rest>;

}  // namespace fieldcast
