// The partition of wanted items into blocks with the least wire time. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"

namespace fieldcast {

// One wanted range. Lists are ordered by `first`; ranges may overlap.
struct Wanted {
  std::uint32_t first = 0;
  std::uint32_t end = 1;
  bool barrier = false;  // no block may hold this range together with the previous one
};

struct Slice {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  friend bool operator==(const Slice&, const Slice&) = default;
};

// A range beyond the limits is a block of its own. Dynamic programming: the time grows with the
// list times the points in one block.
[[nodiscard]] std::vector<Slice> optimal_partition(std::span<const Wanted> wanted,
                                                   const ReadCost& cost);

// REQUIRES: slice is not empty.
[[nodiscard]] Range range_of(std::span<const Wanted> wanted, Slice slice, const ReadCost& cost);

[[nodiscard]] Duration cost_of(std::span<const Wanted> wanted, std::span<const Slice> slices,
                               const ReadCost& cost);

// Splits `points` (by address, all within one read) into the slices with the least wire time per
// second. Each slice is read at the rate of its fastest point; slower points join every n-th read.
// A gap to a slower point is paid at that point's rate. `rates`: reads per second, above 0, in
// steps of a quarter. Dynamic programming.
[[nodiscard]] std::vector<Slice> partition_by_pace(std::span<const Wanted> points,
                                                   std::span<const double> rates,
                                                   const ReadCost& cost);

}  // namespace fieldcast
