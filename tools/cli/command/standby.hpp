// `fieldcast standby`: the bridges of standby groups and which one is master. `standby take NAME`:
// another bridge is to be master.
#pragma once

#include <iosfwd>
#include <string>

#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct StandbyOptions {
  ConnectionOptions connection;
  bool json = false;
  bool take = false;
  std::string wanted;  // of take: a bridge, or a group, whose best waiting bridge takes over
};

// kOk when a member was there, else kNoBridge; of take: kOk when the bridge is master, kNothing for
// a name that nobody has, kRejected when it is not ready, kNoAnswer when nothing happened. Throws
// DdsError.
[[nodiscard]] ExitCode standby(const StandbyOptions& options, const Connection& connection,
                               Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
