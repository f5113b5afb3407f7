// Runs the screen of `fieldcast status`. Main thread. Processes keys immediately, and DDS events at
// least ten times a second.
#pragma once

#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/domain/standby_watch.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; the status is subscribed. Throws std::runtime_error.
void status_live(const Connection& connection, DomainView& domain, StatusModel& model,
                 StandbyWatch& members, Instant end);

}  // namespace fieldcast::cli
