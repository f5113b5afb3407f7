// `fieldcast write`: writes values to channels, or with --at to addresses of a device.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct WriteOptions : CommandOptions {
  std::vector<std::string> words;  // BUS/DEVICE/CHANNEL=VALUE ..; with `at`: BUS/DEVICE VALUE ..
  bool verify = false;
};

// Returns the worst code. Sends nothing if an assignment is refused locally. Throws DdsError.
[[nodiscard]] ExitCode write(const WriteOptions& options, const Connection& connection,
                             Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
