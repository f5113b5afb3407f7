// Runs the screen of `fieldcast watch`. Main thread. Processes keys immediately; reads DDS events
// and draws at least ten times a second.
#pragma once

#include <optional>

#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/command/station/watch.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/screen/watch_screen.hpp"

namespace fieldcast::cli {

// Until `end`, until the user quits, or until the inbox is closed. REQUIRES: no_screen_reason() is
// empty; channels and samples are subscribed. Throws std::runtime_error.
void watch_live(const WatchOptions& options, const Connection& connection, DomainView& domain,
                WatchModel& model, Instant end);

// Sends one write of a screen and receives its result without blocking the screen. Main thread.
class WriteController {
 public:
  // REQUIRES: both outlive this object; `domain` has subscribed to results.
  WriteController(DomainView& domain, const Connection& connection)
      : domain_(domain), connection_(connection) {}

  // REQUIRES: busy() is false.
  void begin(const WriteIntent& intent, Instant now);
  // Returns the outcome if the write ended: no bridge, no right, no result.
  [[nodiscard]] std::optional<Outcome> step(Instant now);
  [[nodiscard]] std::optional<Outcome> on_result(const StationResult& result);
  [[nodiscard]] bool busy() const { return errand_.has_value(); }

 private:
  [[nodiscard]] Outcome finish();
  [[nodiscard]] std::optional<Outcome> fail(Outcome::State state, std::string reason);

  DomainView& domain_;
  const Connection& connection_;
  std::optional<Errand> errand_;
  bool sent_ = false;
  Instant until_{};  // deadline for sending, then for the result
};

}  // namespace fieldcast::cli
