#include "core/plan/refresh.hpp"

#include <algorithm>
#include <cmath>
#include <map>

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

Stretched stretch_points(std::span<PlannedPoint> points, double factor) {
  std::map<std::int8_t, double> rank;  // 0 for the lowest priority
  for (const PlannedPoint& point : points) {
    if (point.wanted()) rank.try_emplace(point.priority, 0);
  }
  double next = 0;
  for (auto& [priority, step] : rank) step = next++;
  const double ranks = static_cast<double>(std::max<std::size_t>(rank.size(), 2));
  const double apart = std::min(kMostPerPriority, std::pow(kMostApart, 1 / (ranks - 1)));
  Stretched result;
  result.priorities = rank.size();
  for (PlannedPoint& point : points) {
    const auto found = rank.find(point.priority);
    const double less = found == rank.end() ? 1.0 : std::pow(apart, found->second);
    point.stretch = 1.0 + std::max(0.0, factor / less - 1.0) * point.elasticity;
    if (!point.wanted()) continue;
    result.greatest = std::max(result.greatest, point.stretch);
    result.least_elasticity =
        std::min(result.least_elasticity, static_cast<double>(point.elasticity));
    result.uneven = result.uneven || point.elasticity != 1.0F;
  }
  return result;
}

}  // namespace fieldcast
