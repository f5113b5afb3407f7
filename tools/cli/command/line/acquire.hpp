// `fieldcast acquire`: reads channels, or with --at addresses, on demand.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct AcquireOptions : CommandOptions {
  std::string target;       // BUS/DEVICE or BUS/DEVICE/CHANNEL
  std::uint32_t count = 1;  // values at the address
};

// Returns the code of the worst result. Throws DdsError.
[[nodiscard]] ExitCode acquire(const AcquireOptions& options, const Connection& connection,
                               Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
