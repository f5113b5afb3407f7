// The screen of `fieldcast watch` at work: terminal, domain and clock around WatchScreen.
//
// Main thread. Reads keys at once, events of the domain at least ten times a second, and draws as
// often.
#pragma once

#include "tools/cli/command/watch.hpp"
#include "tools/cli/domain_view.hpp"
#include "tools/cli/model/watch_model.hpp"

namespace fieldcast::cli {

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; channels and samples are subscribed to. Throws std::runtime_error when the terminal cannot
// be used.
void watch_live(const WatchOptions& options, const Connection& connection, DomainView& domain,
                WatchModel& model, Instant end);

}  // namespace fieldcast::cli
