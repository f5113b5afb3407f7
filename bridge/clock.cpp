#include "bridge/clock.hpp"

#include <limits>

namespace fieldcast {
namespace {

std::int64_t utc_now() {
  return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Instant steady_now() {
  return Instant{std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch())};
}

void UtcClock::resample() {
  // The pair read with the least time between its two monotonic readings is the truest: a preemption in between spoils a pair.
  std::int64_t best_width = std::numeric_limits<std::int64_t>::max();
  for (int attempt = 0; attempt < 3; ++attempt) {
    const std::int64_t before = steady_now().time_since_epoch().count();
    const std::int64_t utc = utc_now();
    const std::int64_t after = steady_now().time_since_epoch().count();
    if (after - before < best_width) {
      best_width = after - before;
      offset_ = utc - (before + (after - before) / 2);
    }
  }
}

UtcTime UtcClock::at(Instant instant) const {
  if (instant == kLongAgo || instant == kNever) return {};
  return {instant.time_since_epoch().count() + offset_};
}

}  // namespace fieldcast
