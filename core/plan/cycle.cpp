#include "core/plan/cycle.hpp"

#include <algorithm>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

Instant due_after(const Cycle& cycle, Instant acquired, Duration allowed_gap) {
  // Minimum used part of the gap to wait for an instant of the cycle.
  constexpr double kWorth = 0.7;
  const Instant latest = acquired + allowed_gap;
  if (cycle.period <= Duration::zero()) return latest;
  const Duration past = since_phase(latest, cycle.phase, cycle.period);
  return ns(allowed_gap - past) >= kWorth * ns(allowed_gap) ? latest - past : latest;
}

Duration cycle_period(Duration allowed_gap, Duration fastest, double margin) {
  const Duration base{static_cast<Duration::rep>(ns(fastest) * (1 - margin))};
  if (base <= Duration::zero()) return Duration::zero();
  // A gap of two base periods allows both, and the margin must not add a third.
  const Duration usable{static_cast<Duration::rep>(ns(allowed_gap) * (1 - margin))};
  return std::max<Duration::rep>(1, (usable + base / 1000) / base) * base;
}

}  // namespace fieldcast
