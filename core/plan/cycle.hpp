// A cycle: instants, one period apart, at which the reads of a group are due.
//
// If each read were due one refresh after the last one, then whatever made a read early would shift
// all that follow, and the phases of a hundred groups would wander and collide. A cycle does not
// move when a read comes a little early or late. The periods of all groups are multiples of one
// base period, which is a little shorter than the fastest refresh of the bus. Pure functions.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

struct Cycle {
  Instant phase{};    // one of its instants, any
  Duration period{};  // zero: no cycle; a read is due one allowed gap after the last one
};

// When a point acquired at `acquired` must be read again: the last instant of the cycle within its
// allowed gap, or the end of that gap if the instant comes too early to be worth it.
[[nodiscard]] Instant due_after(const Cycle& cycle, Instant acquired, Duration allowed_gap);

// The period for a group whose fastest point allows `allowed_gap`, on a bus whose fastest point
// allows `fastest`. `margin`: the part by which periods are shorter than allowed gaps.
[[nodiscard]] Duration cycle_period(Duration allowed_gap, Duration fastest, double margin);

}  // namespace fieldcast
