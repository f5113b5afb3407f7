// Which neighbours are read together with the most urgent point of a group, where one request
// reads one range. Pure functions of the points' states.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/cost.hpp"
#include "core/plan/partition.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

// The numbers of the cyclic schedule. They were found by measuring: core/plan/README.md.
struct CyclicWeights {
  // A point that is due within this part of a period after a read must be part of that read, or it
  // would need a request of its own.
  double reach = 0.8;
  // The base period is shorter than the fastest refresh of the bus by this part.
  double margin = 0.058;
  // This part of the margin is kept for delays that the plan does not know of (noise, retries). The
  // rest is slack: by so much a read may end earlier in its slot than the read before.
  double unforeseen = 0.013;
  // A point that is read again before this share of its allowed gap is used keeps its phase.
  double keep = 0.3;
  // On a lightly loaded bus the margin is larger by this part.
  double light_reserve = 0.08;
  // How often the timetable looks for a better phase for each point.
  unsigned rounds = 6;
  // How many reads the planners without a timetable look ahead.
  unsigned look_ahead = 64;
};

// What a read may take besides the points that must be part of it.
struct Allowance {
  // Wire time of the whole read, with the points that are only better read now than later.
  Duration budget{};
  // Period of the group. Zero: none, its reads follow the shortest allowed gap.
  Duration period{};
};

// Points that are due before this instant must be part of a read of `urgent` at `now`: soon after
// it the group is read again.
[[nodiscard]] Instant must_until(std::span<const PointState> points, std::uint32_t urgent,
                                 Instant now, const Allowance& allowance,
                                 const CyclicWeights& weights);

// The slice of `points` around `urgent` to be read at `now`; `points` are one group. Only ready
// points are worth anything; the slice respects cuts and the limits of `cost`.
[[nodiscard]] Slice cyclic_slice(std::span<const PointState> points, std::uint32_t urgent,
                                 const ReadCost& cost, Instant now, const Allowance& allowance,
                                 const CyclicWeights& weights);

// Every neighbour that has used up half of its allowed gap.
[[nodiscard]] Slice near_slice(std::span<const PointState> points, std::uint32_t urgent,
                               const ReadCost& cost, Instant now);

// Every point of the group that one read with `urgent` can hold.
[[nodiscard]] Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent,
                                const ReadCost& cost, Instant now);

// The range that reads a slice.
[[nodiscard]] Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost);

}  // namespace fieldcast
