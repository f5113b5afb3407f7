// The clocks of the shell: the monotonic clock of the engine, and its relation to UTC for what
// leaves the process.
#pragma once

#include "bridge/dds/topics/utc_mapping.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

[[nodiscard]] Instant steady_now();

// Reads both clocks now. A step of the wall clock (NTP, an operator) is in force from the next
// reading on; owners read once a second. Any thread.
[[nodiscard]] UtcMapping read_clocks();

}  // namespace fieldcast
