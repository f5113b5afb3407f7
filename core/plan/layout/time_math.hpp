// Time arithmetic for planning and dispatching. Pure functions.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

// Saturates at kNever.
[[nodiscard]] constexpr Instant later(Instant at, Duration by) {
  return at >= kNever - by ? kNever : at + by;
}

// Rounded down to whole nanoseconds.
[[nodiscard]] constexpr Duration part_of(double share, Duration whole) {
  return Duration{static_cast<Duration::rep>(share * static_cast<double>(whole.count()))};
}

[[nodiscard]] constexpr double ns(Duration duration) {
  return static_cast<double>(duration.count());
}

// Less than `period`. REQUIRES: period is positive.
[[nodiscard]] constexpr Duration since_phase(Instant at, Instant phase, Duration period) {
  const Duration past = (at - phase) % period;
  return past < Duration::zero() ? past + period : past;
}

}  // namespace fieldcast
