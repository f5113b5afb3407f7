// Which neighbours are read along with the most urgent point of a cluster. Pure functions of the points' states.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/cost.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/point_state.hpp"

namespace fieldcast {

// Weights of the riding rule; found by measuring (see README.md).
struct RidingWeights {
  double horizon =
      1.0;  // a point whose time runs out within this many periods of the cluster's fastest point must ride or pay its own
  double soft = 0.6;      // worth of renewing another point early, in wire time of its items at a full used share
  double power = 1.0;     // how the worth grows with the used share
  double reserve = 0.05;  // wire time kept free of rest before the latest start, in periods of the bus's fastest point
  double ahead = 64;
};

// The slice of `points` around `urgent` to be read at `now`; `points` are one cluster. Only ready points are worth anything; the
// slice respects cuts and the limits of `cost`. Whoever needs no ride yet but is worth one rides while the block takes no longer
// than `budget`.
[[nodiscard]] Slice riding_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost, std::int64_t now,
                                 std::int64_t budget, const RidingWeights& weights = {});

// Every point of the cluster that a block with `urgent` can hold.
[[nodiscard]] Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost, std::int64_t now);

// The range that reads a slice.
[[nodiscard]] Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost);

}  // namespace fieldcast
