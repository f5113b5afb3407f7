// Monotonic instants and UTC stamps. Core reads no clock: `now` is always a parameter.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace fieldcast {

using Duration = std::chrono::nanoseconds;

// A monotonic clock without now(): the shell has a real one, tests a virtual one.
struct EngineClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<EngineClock, Duration>;
  static constexpr bool is_steady = true;
};
using Instant = EngineClock::time_point;

inline constexpr Instant kNever = Instant::max();  // later than all others
// Before all others; never add a Duration to it.
inline constexpr Instant kLongAgo = Instant::min();

// Nanoseconds since 1970-01-01T00:00:00Z; 0 means "no time".
struct UtcTime {
  std::int64_t nanoseconds = 0;
  friend auto operator<=>(const UtcTime&, const UtcTime&) = default;
};

[[nodiscard]] constexpr double to_seconds(Duration d) {
  return std::chrono::duration<double>(d).count();
}
[[nodiscard]] constexpr Duration from_seconds(double s) {
  return Duration{static_cast<std::int64_t>(s * 1e9)};
}

// "200ms", "1.5s", "500us", "2min": the form of configurations and reports.
[[nodiscard]] std::string to_text(Duration d);

}  // namespace fieldcast
