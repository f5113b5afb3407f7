#include "core/plan/stretch.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace fieldcast {

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
