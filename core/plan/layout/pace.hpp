#pragma once

#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"

namespace fieldcast {

// Splits `points` (by address, all within one read) into the slices that need the least wire time
// per second. Each slice is read at the rate of its fastest point; slower points join every n-th
// read. A slice pays its request at its fastest rate, and the gap to a slower point at the rate of
// that point. `rates`: reads per second of each point, above 0. Dynamic programming; rates count in
// steps of a quarter.
[[nodiscard]] std::vector<Slice> partition_by_pace(std::span<const Wanted> points,
                                                   std::span<const double> rates,
                                                   const ReadCost& cost);

}  // namespace fieldcast
