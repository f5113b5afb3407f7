// Runs the screen of `fieldcast watch`. Main thread. Processes keys immediately; reads DDS events
// and draws at least ten times a second.
#pragma once

#include "tools/cli/command/station/watch.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/model/watch_model.hpp"

namespace fieldcast::cli {

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; channels and samples are subscribed. Throws std::runtime_error.
void watch_live(const WatchOptions& options, const Connection& connection, DomainView& domain,
                WatchModel& model, Instant end);

}  // namespace fieldcast::cli
