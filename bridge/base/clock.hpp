// Monotonic clock of the engine, and its mapping to UTC for data that leaves the process.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

[[nodiscard]] Instant steady_now();

// Goes on while the machine sleeps; comparable only with itself.
[[nodiscard]] Instant boot_now();

// Reads both clocks. A step of the wall clock takes effect at the next reading. Any thread.
[[nodiscard]] UtcMapping read_clocks();

}  // namespace fieldcast
