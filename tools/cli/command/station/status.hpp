// `fieldcast status`: state, load, learned times and failures of buses and devices.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

struct StatusOptions {
  ConnectionOptions connection;
  bool json = false;
  bool screen = true;  // if the output is a terminal
  // Empty to print once, or to show the screen until the user quits.
  std::optional<Duration> time;
};

// Returns kOk if a bus reported, else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode status(const StatusOptions& options, const Connection& connection,
                              Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
