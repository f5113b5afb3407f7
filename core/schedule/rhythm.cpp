#include "core/schedule/rhythm.hpp"

#include <algorithm>
#include <cmath>

namespace fieldcast {

std::int64_t due_after(const Beat& beat, std::int64_t acquired, std::int64_t period) {
  constexpr double kWorth = 0.7;  // of the period: a beat before that is not waited for
  const std::int64_t latest = acquired + period;
  if (beat.spacing <= 0) return latest;
  std::int64_t past = (latest - beat.offset) % beat.spacing;
  if (past < 0) past += beat.spacing;
  return static_cast<double>(period - past) >= kWorth * static_cast<double>(period) ? latest - past
                                                                                    : latest;
}

std::int64_t beat_spacing(std::int64_t period, std::int64_t fastest, double margin) {
  const auto beat = static_cast<std::int64_t>(static_cast<double>(fastest) * (1 - margin));
  if (beat <= 0) return 0;
  // Of two beats' period both count, though the margin would allow a little more than two.
  const auto usable = static_cast<std::int64_t>(static_cast<double>(period) * (1 - margin));
  return std::max<std::int64_t>(1, (usable + beat / 1000) / beat) * beat;
}

}  // namespace fieldcast
