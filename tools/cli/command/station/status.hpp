// `fieldcast status`: state, load, learned times and failures of buses and devices.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/cli/view/status/status_facts.hpp"

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

// Runs the screen of `fieldcast status`. Main thread. Processes keys immediately, and DDS events at
// least ten times a second.

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; the status is subscribed. Throws std::runtime_error.
void status_live(const Connection& connection, DomainView& domain, StatusModel& model,
                 StandbyWatch& members, Instant end);

}  // namespace fieldcast::cli
