// Data that a bus continues from another bridge. Plain values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

struct BusInheritance {
  // By channel; sequence 0 if never published. `acquired` uses the clock of the new engine.
  std::vector<Sample> samples;
  std::map<std::string, DeviceReport> devices;  // by name; learned values
  // Sample numbers continue above it, for all channels.
  std::uint64_t above = 0;
};

}  // namespace fieldcast
