// A cycle: instants, one period apart, at which the reads of a group are due. An early or late read
// does not move it, so phases of groups do not drift and collide. All periods are multiples of one
// base period, slightly shorter than the fastest refresh of the bus. Pure functions.
#pragma once

#include <span>

#include "core/base/time.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

struct Cycle {
  Instant phase{};    // any of its instants
  Duration period{};  // zero without a cycle: a read is due one allowed gap after the last one
};

// The last instant of the cycle within the allowed gap, or the end of the gap if that is too early.
[[nodiscard]] Instant due_after(const Cycle& cycle, Instant acquired, Duration allowed_gap);

// `fastest`: smallest allowed gap. `margin`: part by which periods are shorter than gaps.
[[nodiscard]] Duration cycle_period(Duration allowed_gap, Duration fastest, double margin);

// Stretches refreshes if the requests exceed the capacity of the wire. Pure functions.

// Maximum stretch of one priority before the next higher one is stretched.
inline constexpr double kMostPerPriority = 4;
// Ratio between the stretch of the lowest and the highest priority, so that no point starves.
inline constexpr double kMostApart = 16;

struct Stretched {
  double greatest = 1;          // of all wanted points
  double least_elasticity = 1;  // of all wanted points
  bool uneven = false;          // not every elasticity is 1
  std::size_t priorities = 0;
};

// Sets the stretch of every point, from the lowest priority to the highest, each up to
// kMostPerPriority before the next, then all. Within a priority, elasticity determines the share of
// each point (Buttazzo, Lipari, Abeni: Elastic Task Model, 1998).
Stretched stretch_points(std::span<PlannedPoint> points, double factor);

}  // namespace fieldcast
