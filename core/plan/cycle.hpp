// A cycle: instants, one period apart, at which the reads of a group are due.
//
// A read that is early or late does not move its cycle, so the phases of groups do not drift and
// collide. The periods of all groups are multiples of one base period, slightly shorter than the
// fastest refresh of the bus. Pure functions.
#pragma once

#include "core/base/time.hpp"

namespace fieldcast {

struct Cycle {
  Instant phase{};    // any of its instants
  Duration period{};  // zero without a cycle: a read is due one allowed gap after the last one
};

// The last instant of the cycle within the allowed gap, or the end of the gap if that is too early.
[[nodiscard]] Instant due_after(const Cycle& cycle, Instant acquired, Duration allowed_gap);

// `fastest`: smallest allowed gap of the bus. `margin`: part by which periods are shorter than
// gaps.
[[nodiscard]] Duration cycle_period(Duration allowed_gap, Duration fastest, double margin);

}  // namespace fieldcast
