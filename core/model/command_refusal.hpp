// The only place that creates the result of a rejected command. Pure.
#pragma once

#include <string>

#include "core/model/command.hpp"

namespace fieldcast {

// `state`: kRejected, or kExpired for a late command. `reason`: one human-readable line.
[[nodiscard]] CommandResult refusal(const Command& command, CommandState state, Cause cause,
                                    std::string reason, Instant received, Instant now);

[[nodiscard]] CommandResult rejection(const Command& command, Cause cause, std::string reason,
                                      Instant now);

}  // namespace fieldcast
