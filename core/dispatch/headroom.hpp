// Whether the wire has time for another use than the plan, as a read of a gateway's client.
#pragma once

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

// Returns true if the next reads are in time after the wire was used otherwise for `use`: rehearses
// them, at most kMostAhead or kHorizon. `runner`: a copy of the present state. The time is that of
// the copy and of the reads, some 0.1 ms for a serial line. REQUIRES: the wire is free at `now`.
[[nodiscard]] bool has_headroom(PlanRunner runner, Instant now, Duration use);

}  // namespace fieldcast
