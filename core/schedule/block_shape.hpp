// Which neighbours are read along with the most urgent point of a cluster. Pure functions of the
// points' states.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/cost.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/point_state.hpp"

namespace fieldcast {

// The riding planner's numbers; found by measuring (README.md beside this file says how).
struct RidingWeights {
  double reach = 0.8;  // a point due within this part of a beat after the read must ride, or would
                       // need a request of its own
  double margin = 0.058;  // the beat is shorter than the fastest period by this part,
  double give = 0.013;  // of which so much is for what nobody foresaw, and the rest for reads that
                        // end sooner or later in their frame
  double keep = 0.3;    // a point renewed before this share of its period is used keeps its turn
  double light_reserve = 0.08;  // on a bus with room the beat is shorter by as much more
  unsigned rounds = 6;  // how often each rider looks for a better turn when the timetable is made
  unsigned look_ahead = 64;  // reads, for the planners without a timetable
};

// What a block may take besides those who must come.
struct Allowance {
  std::int64_t budget =
      0;  // of wire time, for the whole block, for those who are only better read now than later
  std::int64_t spacing = 0;  // of the cluster's beat; 0: none, its reads follow the shortest period
};

// When the cluster is read again, if `urgent` is read now. Whoever is due until then must ride
// along.
[[nodiscard]] std::int64_t next_turn(std::span<const PointState> points, std::uint32_t urgent,
                                     std::int64_t now, const Allowance& allowance,
                                     const RidingWeights& weights);

// The slice of `points` around `urgent` to be read at `now`; `points` are one cluster. Only ready
// points are worth anything; the slice respects cuts and the limits of `cost`.
[[nodiscard]] Slice riding_slice(std::span<const PointState> points, std::uint32_t urgent,
                                 const ReadCost& cost, std::int64_t now, const Allowance& allowance,
                                 const RidingWeights& weights);

// Every neighbour that has used up half of its period.
[[nodiscard]] Slice near_slice(std::span<const PointState> points, std::uint32_t urgent,
                               const ReadCost& cost, std::int64_t now);

// Every point of the cluster that a block with `urgent` can hold.
[[nodiscard]] Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent,
                                const ReadCost& cost, std::int64_t now);

// The range that reads a slice.
[[nodiscard]] Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost);

}  // namespace fieldcast
