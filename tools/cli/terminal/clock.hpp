// The two clocks of a command: monotonic for waits and rates, UTC for ages.
#pragma once

#include <chrono>

#include "core/base/time.hpp"

namespace fieldcast::cli {

[[nodiscard]] inline Instant instant_now() {
  return Instant{std::chrono::steady_clock::now().time_since_epoch()};
}

[[nodiscard]] inline UtcTime utc_now() {
  return UtcTime{
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
          .count()};
}

[[nodiscard]] inline std::chrono::steady_clock::time_point to_steady(Instant at) {
  return std::chrono::steady_clock::time_point{at.time_since_epoch()};
}

}  // namespace fieldcast::cli
