// Runs a command in a DDS domain, with signals blocked before DDS starts threads. Main thread.
#pragma once

#include <functional>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

using DomainCommand = std::function<ExitCode(const Connection& connection, Interrupt& interrupt)>;

// kUsage if the configuration file has faults.
[[nodiscard]] ExitCode in_domain(const ConnectionOptions& options, const Streams& streams,
                                 const DomainCommand& command);

}  // namespace fieldcast::cli
