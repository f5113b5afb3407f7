// A lower bound on the wire time that any master needs for the refreshes of a bus, with a proof.
//
// The proof is a price for each point: wire time that every read pays for each of its points. If no
// request costs less than the prices of all points that it can read, then a master that reads each
// point at least once in its refresh needs at least the sum of price / refresh. The prices are the
// dual of a linear programme whose columns are all requests. Pure functions.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"

namespace fieldcast {

struct LoadBound {
  double load = 0;               // share of the wire; above 1 no master can keep the refreshes
  std::vector<Duration> prices;  // by PointIndex
};

// Empty for a bus whose requests contain lists of ranges, or with more than 2 000 points in one
// area of a device. Points on demand have no price: only the other modes promise a refresh.
[[nodiscard]] std::optional<LoadBound> load_bound_of(const ScheduleInput& input);

// The load that the prices prove. Empty if they prove nothing: a price is negative, or a request
// costs less than the prices of its points. Does not depend on how the prices were found.
[[nodiscard]] std::optional<double> proven_load(const ScheduleInput& input,
                                                std::span<const Duration> prices);

}  // namespace fieldcast
