// `fieldcast standby`: lists standby groups. `standby take NAME`: makes another bridge the master.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

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
