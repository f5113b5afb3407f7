// The command line as values: one alternative for each subcommand.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <variant>

#include "tools/cli/acquire.hpp"
#include "tools/cli/alarms.hpp"
#include "tools/cli/history.hpp"
#include "tools/cli/inspect.hpp"
#include "tools/cli/plan.hpp"
#include "tools/cli/records.hpp"
#include "tools/cli/sessions.hpp"
#include "tools/cli/sim_check.hpp"
#include "tools/cli/status.hpp"
#include "tools/cli/user.hpp"
#include "tools/cli/watch.hpp"
#include "tools/cli/write.hpp"

namespace fieldcast::cli {

using Arguments =
    std::variant<InspectOptions, WatchOptions, WriteOptions, AcquireOptions, StatusOptions, SessionsOptions, PlanOptions,
                 SimCheckOptions, HistoryOptions, DevicesOptions, AuditOptions, UserOptions, AlarmsOptions>;

// Not a command to be run: help, the version, or a fault with what is wrong.
struct NoCommand {
  ExitCode code = ExitCode::kOk;
  std::string text;
};

[[nodiscard]] tl::expected<Arguments, NoCommand> parse_arguments(int argc, const char* const* argv);

}  // namespace fieldcast::cli
