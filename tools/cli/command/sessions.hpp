// `fieldcast sessions`: who programs which device through the bridges, and how much went either
// way.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct SessionsOptions {
  ConnectionOptions connection;
  bool json = false;
  std::optional<Duration> time;  // follows them for so long, a line for each report; nothing: once
};

// kOk when a bridge is there, with or without sessions, else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode sessions(const SessionsOptions& options, const Connection& connection,
                                Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
