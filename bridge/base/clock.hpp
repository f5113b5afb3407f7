// Monotonic clock of the engine, and its mapping to UTC for data that leaves the process.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

[[nodiscard]] Instant steady_now();

// Reads both clocks now. A step of the wall clock (NTP, an operator) takes effect at the next
// reading; owners read once a second. Any thread.
[[nodiscard]] UtcMapping read_clocks();

}  // namespace fieldcast
