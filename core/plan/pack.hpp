// Packs: points of one device that share requests, where a request carries a list of ranges.
//
// All points of a device could be one group, since distance does not matter in a list. But a
// request has limits, and a long one delays all others on the bus. So points are put into packs,
// the fastest together. A pack is as large as its average request may be: a point with ten times
// the refresh of the fastest one is part of every tenth request. Pure functions.
#pragma once

#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"
#include "core/plan/partition.hpp"
#include "core/plan/point.hpp"

namespace fieldcast {

// Points of one area of a device, by address, and what it costs to read one range of that area.
struct AreaPoints {
  std::span<const PointIndex> points;
  const ReadCost& cost;
};

// The packs of one device, each ordered by area and address. `areas`: those whose ranges may stand
// in lists. Points that are cheaper to read by requests of their own (many neighbours, where a list
// names every item) are left out.
[[nodiscard]] std::vector<std::vector<PointIndex>> make_packs(std::span<const Point> points,
                                                              std::span<const AreaPoints> areas,
                                                              const ListCost& cost);

}  // namespace fieldcast
