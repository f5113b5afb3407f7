// Computes the optimal requests of lists of ranges, as a reference for schedulers.
#pragma once

#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"

namespace fieldcast::test {

struct BestRequests {
  std::vector<ReadRequest> requests;
  Duration cost{};
};

// `wanted` is of one area, in ascending order. Adjacent ranges are joined if bridging is cheaper
// than another range. Each request holds consecutive ranges, or one range over all of them if that
// is cheaper.
[[nodiscard]] BestRequests best_requests(std::span<const Range> wanted, const ListCost& cost);

}  // namespace fieldcast::test
