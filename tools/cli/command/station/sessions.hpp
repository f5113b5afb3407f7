// `fieldcast sessions`: lists programming sessions with their users, devices and byte counts.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

struct SessionsOptions {
  ConnectionOptions connection;
  bool json = false;
  // follows them for this time, one line for each report; empty: print once
  std::optional<Duration> time;
};

// Returns kOk if a bridge reported, with or without sessions, else kNoBridge. Throws DdsError.
[[nodiscard]] ExitCode sessions(const SessionsOptions& options, const Connection& connection,
                                Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
