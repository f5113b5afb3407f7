// What a bus takes over from the bridge that served it before: the last samples and what was
// learned of its devices. Plain values.
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
  // By channel; with sequence 0 for those that were never published. `acquired` is on the clock of
  // the engine that takes over.
  std::vector<Sample> samples;
  std::map<std::string, DeviceReport> devices;  // by name; what was learned
  // Samples count on from above it, also those of channels that were never published.
  std::uint64_t above = 0;
};

}  // namespace fieldcast
