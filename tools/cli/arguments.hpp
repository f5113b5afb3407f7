// The command line as values: one alternative for each subcommand.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <variant>

#include "tools/cli/command/acquire.hpp"
#include "tools/cli/command/alarms.hpp"
#include "tools/cli/command/history.hpp"
#include "tools/cli/command/inspect.hpp"
#include "tools/cli/command/plan.hpp"
#include "tools/cli/command/records.hpp"
#include "tools/cli/command/sessions.hpp"
#include "tools/cli/command/sim_check.hpp"
#include "tools/cli/command/status.hpp"
#include "tools/cli/command/user.hpp"
#include "tools/cli/command/watch.hpp"
#include "tools/cli/command/write.hpp"

namespace fieldcast::cli {

using Arguments =
    std::variant<InspectOptions, WatchOptions, WriteOptions, AcquireOptions, StatusOptions,
                 SessionsOptions, PlanOptions, SimCheckOptions, HistoryOptions, DevicesOptions,
                 AuditOptions, UserOptions, AlarmsOptions>;

// Not a command to be run: help, the version, or a fault with what is wrong.
struct NoCommand {
  ExitCode code = ExitCode::kOk;
  std::string text;
};

[[nodiscard]] tl::expected<Arguments, NoCommand> parse_arguments(int argc, const char* const* argv);

}  // namespace fieldcast::cli
