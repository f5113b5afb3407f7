// Protects the memory of a process that holds secrets. Call once at the start of main().
#pragma once

#include <string>

namespace fieldcast {

// Disables core dumps and access to the memory by processes of the same user (PR_SET_DUMPABLE,
// RLIMIT_CORE). Does nothing with FIELDCAST_CORE_DUMPS=1 in the environment, for debugging.
void guard_memory();

// Returns one line for the log about each protection that is missing, including secrets that may be
// swapped; empty if all are active.
[[nodiscard]] std::string unguarded_memory();

}  // namespace fieldcast
