// `fieldcast status`: buses and devices, their state, load, learned times and failures by cause.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct StatusOptions {
  ConnectionOptions connection;
  bool json = false;
  bool screen = true;  // where the output is a terminal
  // Follows it for so long: the screen, or a line for each report; nothing: once, or until the
  // user leaves the screen.
  std::optional<Duration> time;
};

// kOk when a bus reported, else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode status(const StatusOptions& options, const Connection& connection,
                              Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
