// Arithmetic on instants and durations that planning and dispatching share. Pure functions.
#pragma once

#include <limits>

#include "core/base/time.hpp"

namespace fieldcast {

// `by` after `at`; kNever, if that is beyond all time.
[[nodiscard]] constexpr Instant later(Instant at, Duration by) {
  return at >= kNever - by ? kNever : at + by;
}

// A share of a duration, rounded down to whole nanoseconds.
[[nodiscard]] constexpr Duration part_of(double share, Duration whole) {
  return Duration{static_cast<Duration::rep>(share * static_cast<double>(whole.count()))};
}

// A duration as a number, for ratios of durations.
[[nodiscard]] constexpr double ns(Duration duration) {
  return static_cast<double>(duration.count());
}

// How far `at` lies behind the last instant of a cycle that has one at `phase`: from zero to less
// than `period`. REQUIRES: period is positive.
[[nodiscard]] constexpr Duration since_phase(Instant at, Instant phase, Duration period) {
  const Duration past = (at - phase) % period;
  return past < Duration::zero() ? past + period : past;
}

}  // namespace fieldcast
