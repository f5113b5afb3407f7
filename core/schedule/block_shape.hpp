// Which neighbours are read along with the most urgent point of a cluster. Pure functions of the points' states.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/cost.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/point_state.hpp"

namespace fieldcast {

// The riding planner's numbers; found by measuring (README.md beside this file says how).
struct RidingWeights {
  double reach = 0.8;     // a point due within this part of a beat after the read must ride, or would need a request of its own
  double early = 2.0;     // what renewing a point one beat early is worth, in wire time of its items; only up to `level`
  double level = 1.3;     // a read may be filled up with early riders to this many times the cluster's average
  double longest = 0.08;  // of a beat: a longer read is not made longer by those who could come later
  double margin = 0.06;   // the beat is shorter than the fastest period by this part
  double keep = 0.3;      // a point renewed before this share of its period is used keeps its turn
  double reserve = 0.02;  // of the fastest period: the rest ends this much before it must
  double light_reserve = 0.08;  // the same on a bus with room; its beat is shorter by as much
  double press = 0.12;          // of the fastest period: a deadline nearer than this goes before the beat when there is no slack
  unsigned look_ahead = 64;     // reads
};

// What a block may take besides those who must come.
struct Allowance {
  std::int64_t budget = 0;          // of wire time, for the whole block, for those who are only better read now than later
  std::int64_t level = 0;           // the same for riders one beat early
  std::int64_t longest = kNeverNs;  // wire time that those who must come may fill, if they could come in another block
  std::int64_t spacing = 0;         // of the cluster's beat; 0: none, its reads follow the shortest period
  bool pressed = false;             // only those whose deadline, not just their turn, ends before the next read
};

// When the cluster is read again, and once more after that, if `urgent` is read now.
struct Turn {
  std::int64_t next_read = 0, one_later = 0;
};
[[nodiscard]] Turn next_turn(std::span<const PointState> points, std::uint32_t urgent, std::int64_t now, const Allowance& allowance,
                             const RidingWeights& weights);

// The slice of `points` around `urgent` to be read at `now`; `points` are one cluster. Only ready points are worth anything; the
// slice respects cuts and the limits of `cost`.
[[nodiscard]] Slice riding_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost, std::int64_t now,
                                 const Allowance& allowance, const RidingWeights& weights);

// Every neighbour that has used up half of its period.
[[nodiscard]] Slice near_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost, std::int64_t now);

// Every point of the cluster that a block with `urgent` can hold.
[[nodiscard]] Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost, std::int64_t now);

// The range that reads a slice.
[[nodiscard]] Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost);

}  // namespace fieldcast
