#include "bridge/base/clock.hpp"

#include <ctime>

namespace fieldcast {

Instant steady_now() {
  return Instant{
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch())};
}

Instant boot_now() {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return Instant{std::chrono::seconds{now.tv_sec} + std::chrono::nanoseconds{now.tv_nsec}};
}

UtcMapping read_clocks() {
  // The shortest of three readings is the most exact: a preemption falsifies a reading.
  UtcMapping best;
  Duration least = Duration::max();
  for (int attempt = 0; attempt < 3; ++attempt) {
    const Instant before = steady_now();
    const auto utc =
        std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch());
    const Duration around = steady_now() - before;
    if (around >= least) continue;
    least = around;
    best = {before + around / 2, UtcTime{utc.count()}};
  }
  return best;
}

}  // namespace fieldcast
