// Selects the neighbours read together with the most urgent point, with one range per request.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

// Parameters of the cyclic schedule, found by measurement: see core/plan/README.md.
struct CyclicWeights {
  // A point due within this part of a period after a read joins it, to avoid a separate request.
  double reach = 0.8;
  // Part by which the base period is shorter than the fastest refresh of the bus; on a wire that
  // has no time for it, as little as `least_margin`.
  double margin = 0.058, least_margin = 0.008;
  // Part of an allowed gap that is kept for unplanned delays (noise, retries), if possible.
  double unforeseen = 0.013;
  // A point that is read again before it used this share of its allowed gap keeps its phase.
  double keep = 0.3;
  // Additional margin on a lightly loaded bus.
  double light_reserve = 0.1;
  unsigned rounds = 6;
  bool search = true;  // for rounds of equal length, which takes up to a second
  // Reads that planners without a timetable look ahead.
  unsigned look_ahead = 64;
};

struct Allowance {
  // Wire time of the whole read, including optional points.
  Duration budget{};
  // Period of the group; zero if its reads follow the shortest allowed gap.
  Duration period{};
};

// Which points must be part of a read of `urgent` at `now`. An intensive point has no phase: it
// joins if it is due before the next read of its group ends, because a read of its own may not fit
// between the two.
struct JoinRule {
  Instant scheduled, intensive;  // points that are due later do not join
  [[nodiscard]] bool joins(const PointState& point) const {
    return point.due <= (point.mode == Mode::kIntensive ? intensive : scheduled);
  }
};
[[nodiscard]] JoinRule join_rule(std::span<const PointState> points, std::uint32_t urgent,
                                 Instant now, const Allowance& allowance,
                                 const CyclicWeights& weights);

// Respects cuts and the limits of `cost`; only ready points have a value.
[[nodiscard]] Slice cyclic_slice(std::span<const PointState> points, std::uint32_t urgent,
                                 const ReadCost& cost, Instant now, const Allowance& allowance,
                                 const CyclicWeights& weights);

[[nodiscard]] Slice near_slice(std::span<const PointState> points, std::uint32_t urgent,
                               const ReadCost& cost, Instant now);

[[nodiscard]] Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent,
                                const ReadCost& cost, Instant now);

[[nodiscard]] Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost);

}  // namespace fieldcast
