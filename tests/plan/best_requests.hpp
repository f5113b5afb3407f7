// The requests of least wire time that read all wanted items, for protocols whose requests contain
// lists of ranges; the reference for a scheduler.
#pragma once

#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"

namespace fieldcast::test {

struct BestRequests {
  std::vector<ReadRequest> requests;
  Duration cost{};
};

// `wanted` is of one area, in rising order. Neighbours are joined if bridging is cheaper than
// another range. Each request has consecutive ranges, or one range over all of them if that is
// cheaper.
[[nodiscard]] BestRequests best_requests(std::span<const Range> wanted, const ListCost& cost);

}  // namespace fieldcast::test
