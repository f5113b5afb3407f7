// A rehearsal: a plan is run on an ideal wire in virtual time, before it goes into force. Pure
// functions; any thread.
#pragma once

#include <cstdint>
#include <limits>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

inline constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

// How many acquisitions come late, counted up to `enough`, until every point was read twice (at
// most 20 000 reads). The wire is free at `now`. `runner`: a copy, in the state in which the plan
// begins.
[[nodiscard]] std::uint64_t count_late(PlanRunner runner, Instant now,
                                       std::uint64_t enough = kAnyNumber);

}  // namespace fieldcast
