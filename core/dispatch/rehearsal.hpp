// Runs a plan in virtual time before it is adopted. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <limits>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {

inline constexpr std::uint64_t kAnyNumber = std::numeric_limits<std::uint64_t>::max();

// Late acquisitions, at most `enough`, until every point was read twice (at most 20 000 reads).
// `runner`: a copy, in the state at the start of the plan.
[[nodiscard]] std::uint64_t count_late(PlanRunner runner, Instant now,
                                       std::uint64_t enough = kAnyNumber);

}  // namespace fieldcast
