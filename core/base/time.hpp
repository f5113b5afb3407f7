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

// Limited to the range of 64 bits; for times in nanoseconds from the network.
[[nodiscard]] constexpr std::int64_t saturated_sum(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) return a < 0 ? INT64_MIN : INT64_MAX;
  return sum;
}
[[nodiscard]] constexpr std::int64_t saturated_difference(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a, b, &difference)) return a < 0 ? INT64_MIN : INT64_MAX;
  return difference;
}

// One reading of both clocks: converts instants to UTC and back. A plain value; any thread.
struct UtcMapping {
  Instant instant{};  // of the engine's clock
  UtcTime utc{};      // of the wall clock, at the same moment

  // Returns 0 ("no such time") for kLongAgo and kNever. Saturates instead of wrapping.
  [[nodiscard]] UtcTime to_utc(Instant at) const;
  [[nodiscard]] Instant to_instant(UtcTime at) const;

  // Differences below this are ignored: a reading of the clocks itself lasts some time.
  static constexpr Duration kSame = std::chrono::microseconds{100};
  // Returns this mapping while `newer` agrees, so that one instant always gives the same time.
  [[nodiscard]] UtcMapping followed_by(const UtcMapping& newer) const;
};

}  // namespace fieldcast
