// `fieldcast sessions`: lists programming sessions with their users, devices and byte counts.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

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

// `fieldcast standby`: lists standby groups. `standby take NAME`: makes another bridge the master.

struct StandbyOptions {
  ConnectionOptions connection;
  bool json = false;
  bool take = false;
  std::string wanted;  // for `take`: a bridge, or a group, whose best waiting bridge takes over
};

// Returns kNoBridge if no member reported. For `take`: returns kNothing for an unknown name,
// kRejected if it is not ready, kNoAnswer if nothing changed. Throws DdsError.
[[nodiscard]] ExitCode standby(const StandbyOptions& options, const Connection& connection,
                               Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
