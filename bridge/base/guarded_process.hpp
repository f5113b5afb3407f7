// The memory of a process that holds secrets. Called once at the start of main().
#pragma once

#include <string>

namespace fieldcast {

// No core dump is written of this process, and no process of the same user reads its memory
// (PR_SET_DUMPABLE, RLIMIT_CORE). With FIELDCAST_CORE_DUMPS=1 in its environment nothing changes,
// for those who look for a fault.
void guard_memory();

// What of this does not hold, in one line for a log; empty: all of it does. Sees too whether
// secrets are kept out of swap.
[[nodiscard]] std::string unguarded_memory();

}  // namespace fieldcast
