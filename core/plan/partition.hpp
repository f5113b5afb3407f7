// The optimal partition of wanted items into reads: every item in one block, the sum of the wire
// times least. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/cost.hpp"

namespace fieldcast {

// One wanted range of items. A list of them is ordered by `first`; they may overlap.
struct Wanted {
  std::uint32_t first = 0;
  std::uint32_t end = 1;
  bool barrier = false;  // no block may hold this one together with the one before it
};

// Entries begin .. end-1 of the list, read together.
struct Slice {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  friend bool operator==(const Slice&, const Slice&) = default;
};

// Blocks in the order of the list. A wanted range that no block may hold (longer than the limits)
// is a block of its own. Dynamic programming over the list; time grows with its length times the
// points in one block.
[[nodiscard]] std::vector<Slice> optimal_partition(std::span<const Wanted> wanted,
                                                   const ReadCost& cost);

// Range that reads a slice. REQUIRES: slice is not empty.
[[nodiscard]] Range range_of(std::span<const Wanted> wanted, Slice slice, const ReadCost& cost);

// Wire time of a partition.
[[nodiscard]] Duration cost_of(std::span<const Wanted> wanted, std::span<const Slice> slices,
                               const ReadCost& cost);

}  // namespace fieldcast
