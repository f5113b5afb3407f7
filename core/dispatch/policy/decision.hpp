#pragma once

#include <variant>
#include <vector>

#include "core/plan/layout/cost.hpp"

namespace fieldcast {

// One read: the ranges of one request and the points that it reads.
struct Block {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::vector<PointIndex> points;
  Duration cost{};  // wire time: request, response, response time, silence, pause
};

// No read is useful before then.
struct Rest {
  Instant until = kNever;
};

using Decision = std::variant<Block, Rest>;

}  // namespace fieldcast
