// Which neighbours share a request when their refreshes differ: a partition by how often each is
// read.
#pragma once

#include <span>
#include <vector>

#include "core/plan/cost.hpp"
#include "core/plan/partition.hpp"

namespace fieldcast {

// Cuts `points` (by address, all of them fit into one read) into the slices whose reads need the
// least wire time per second, if each slice is read as often as its fastest point and slower ones
// are part of every n-th of its reads. `rates`: reads a second of each point, above 0. A slice pays
// its request at the rate of its fastest point, and the gap to slower points at theirs.
// Dynamic programming; rates count in steps of a quarter.
[[nodiscard]] std::vector<Slice> partition_by_pace(std::span<const Wanted> points,
                                                   std::span<const double> rates,
                                                   const ReadCost& cost);

}  // namespace fieldcast
