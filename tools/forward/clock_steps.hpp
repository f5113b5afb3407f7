// Detects steps of the wall clock by the monotonic clock. Pure; one owner.
#pragma once

#include <chrono>
#include <optional>

#include "core/base/time.hpp"

namespace fieldcast::forward {

class ClockSteps {
 public:
  // Smaller changes are ignored: NTP slews the clock by less between two readings.
  static constexpr Duration kLeast = std::chrono::seconds{2};

  // Returns by how much the wall clock was set since the previous reading, negative for back; zero
  // if it was not.
  [[nodiscard]] Duration on_reading(const UtcMapping& reading) {
    const std::int64_t ahead = reading.utc.nanoseconds - reading.instant.time_since_epoch().count();
    const Duration step{ahead - ahead_.value_or(ahead)};
    ahead_ = ahead;
    return step >= kLeast || step <= -kLeast ? step : Duration{};
  }

 private:
  std::optional<std::int64_t> ahead_;  // nanoseconds from the monotonic to the wall clock
};

}  // namespace fieldcast::forward
