// The result of a command that does not run: the one place where such a result is made. Pure.
#pragma once

#include <string>

#include "core/model/command.hpp"

namespace fieldcast {

// `state` is kRejected, or kExpired for a command that is too late. The reason is one line for
// people. Nothing reached the wire: it began and ended at `now`.
[[nodiscard]] CommandResult refusal(const Command& command, CommandState state, Cause cause,
                                    std::string reason, Instant received, Instant now);

// Rejected on the spot.
[[nodiscard]] CommandResult rejection(const Command& command, Cause cause, std::string reason,
                                      Instant now);

}  // namespace fieldcast
