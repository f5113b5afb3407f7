// What was learned of the addresses of one device. Plain state of the engine's read path.
#pragma once

#include <map>
#include <vector>

#include "core/bus/block_learning.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

struct DeviceRuntime {
  std::vector<BlockLearning> areas;             // as the protocol has them
  bool refused_longer = false;                  // a read longer than its block: not tried again
  std::map<PointIndex, std::uint16_t> refused;  // points refused at present, with the device's code
};

}  // namespace fieldcast
