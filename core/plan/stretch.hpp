// Stretches refreshes if the requests exceed the capacity of the wire. Pure functions.
#pragma once

#include <span>

#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

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
