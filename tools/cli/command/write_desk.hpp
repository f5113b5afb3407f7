// One write from a screen to its result, without waiting: the loop of the screen goes on meanwhile.
// The rights are those of `fieldcast write`. Main thread.
#pragma once

#include <optional>

#include "tools/cli/command/command_run.hpp"
#include "tools/cli/screen/watch_screen.hpp"

namespace fieldcast::cli {

class WriteDesk {
 public:
  // REQUIRES: both live longer, and the domain view has subscribed to results.
  WriteDesk(DomainView& domain, const Connection& connection)
      : domain_(domain), connection_(connection) {}

  // REQUIRES: the one before has its outcome.
  void begin(const WriteIntent& intent, Instant now);
  // Sends what is not sent yet. The outcome when there is one: no bridge, no right, no result.
  [[nodiscard]] std::optional<Outcome> step(Instant now);
  // The outcome when the result is the write's.
  [[nodiscard]] std::optional<Outcome> on_result(const StationResult& result);
  [[nodiscard]] bool busy() const { return errand_.has_value(); }

 private:
  [[nodiscard]] Outcome finish();
  [[nodiscard]] std::optional<Outcome> fail(Outcome::State state, std::string reason);

  DomainView& domain_;
  const Connection& connection_;
  std::optional<Errand> errand_;
  bool sent_ = false;
  Instant until_{};  // for sending, then for the result
};

}  // namespace fieldcast::cli
