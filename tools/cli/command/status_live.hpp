// The screen of `fieldcast status` at work: terminal, domain and clock around StatusScreen.
//
// Main thread. Reads keys at once, events of the domain at least ten times a second.
#pragma once

#include "tools/cli/connection.hpp"
#include "tools/cli/domain_view.hpp"
#include "tools/cli/standby_watch.hpp"
#include "tools/cli/view/status_facts.hpp"

namespace fieldcast::cli {

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; the status is subscribed to. Throws std::runtime_error when the terminal cannot be used.
void status_live(const Connection& connection, DomainView& domain, StatusModel& model,
                 StandbyWatch& members, Instant end);

}  // namespace fieldcast::cli
