// The requests of least wire time that together read all of what is wanted, for protocols whose
// requests carry lists of ranges: what a scheduler is held against.
#pragma once

#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"

namespace fieldcast::test {

struct BestRequests {
  std::vector<ReadRequest> requests;
  Duration cost{};
};

// `wanted` is of one area, in rising order. Neighbours are joined where bridging is cheaper than
// another range; each request holds consecutive ranges, or one range over all of them where that is
// cheaper.
[[nodiscard]] BestRequests best_requests(std::span<const Range> wanted, const ListCost& cost);

}  // namespace fieldcast::test
