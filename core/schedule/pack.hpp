// Packs: points of one device that share requests, where a request carries a list of ranges.
//
// All points of a device could be one cluster, as nothing is too far away. But a request has
// limits, and its length costs the others on the bus; so points are put into packs, the fastest
// together, each as large as an average request of it may be: a point with ten times the refresh of
// the fastest one comes along every tenth time. Pure.
#pragma once

#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

// The packs of one device, each ordered by area and address. `strips`: its points by address, one
// list for each area whose ranges may stand in lists, with the cost of reading one range of it.
// Points that are cheaper to read by requests of their own (many neighbours, where a list names
// every item) are left out.
struct StripPoints {
  std::span<const PointIndex> points;
  const ReadCost& cost;
};
[[nodiscard]] std::vector<std::vector<PointIndex>> make_packs(std::span<const Point> points,
                                                              std::span<const StripPoints> strips,
                                                              const ListCost& cost);

}  // namespace fieldcast
