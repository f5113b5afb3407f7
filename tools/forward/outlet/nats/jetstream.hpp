// The outlet for NATS JetStream, by the C client nats.c. Connects without end: after a loss, and
// after a refused login with the files read again. Callbacks run on threads of the library.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

class JetStreamOutlet final : public Outlet {
 public:
  JetStreamOutlet(const JetStreamSpec& spec, OutletContext context);
  // Waits for the threads of the library.
  ~JetStreamOutlet() override;

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  void report(const SiteStatus& status) override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::forward
