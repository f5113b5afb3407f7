// Packs: points of one device that share requests with a list of ranges. Distance does not matter
// in a list, but requests have limits, and a long one delays all others on the bus. So the fastest
// points are packed together, up to the size of an average request: a point with ten times the
// fastest refresh joins every tenth request. Pure functions.
#pragma once

#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"

namespace fieldcast {

struct AreaPoints {
  std::span<const PointIndex> points;
  const ReadCost& cost;
};

// `areas`: those that support lists. Omits points that are cheaper in separate requests.
[[nodiscard]] std::vector<std::vector<PointIndex>> make_packs(std::span<const Point> points,
                                                              std::span<const AreaPoints> areas,
                                                              const ListCost& cost);

}  // namespace fieldcast
