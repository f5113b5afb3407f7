// The two clocks of the shell: the monotonic one that the engine lives by, and UTC for what leaves the process.
// UtcClock is a plain value; each owner uses its own on its own thread.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

[[nodiscard]] Instant steady_now();

// Maps monotonic instants to UTC. The offset between the clocks is sampled by resample(); a step of the wall clock (NTP, an
// operator) is followed from the next sample on. Between samples stamps never run against the monotonic order.
class UtcClock {
 public:
  UtcClock() { resample(); }
  void resample();
  // {0} for kLongAgo and kNever: no such time.
  [[nodiscard]] UtcTime at(Instant instant) const;

 private:
  std::int64_t offset_ = 0;  // UTC nanoseconds minus monotonic nanoseconds
};

}  // namespace fieldcast
