// Overload: more is asked of the wire than it carries, and refreshes are stretched. Pure functions.
#pragma once

#include <span>

#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

// How far points of one priority are stretched before those of the next higher one are.
inline constexpr double kMostPerPriority = 4;
// How much further the lowest priority is stretched than the highest: nobody starves.
inline constexpr double kMostApart = 16;

struct Stretched {
  double greatest = 1;          // of all wanted points
  double least_elasticity = 1;  // of all wanted points
  bool uneven = false;          // not every elasticity is 1
  std::size_t priorities = 0;
};

// Sets the stretch of every point. Those of the lowest priority are stretched first, each priority
// up to kMostPerPriority before the next one, then all. Within a priority each point takes its
// share by its elasticity (Buttazzo, Lipari, Abeni: Elastic Task Model, 1998).
Stretched stretch_points(std::span<PlannedPoint> points, double factor);

}  // namespace fieldcast
