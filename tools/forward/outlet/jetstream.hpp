// The outlet for NATS JetStream, by the C client nats.c. Connects without end: after a loss, and
// after a refused login with the files read again. Callbacks run on threads of the library.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tools/forward/outlet/jetstream_spec.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

class JetStreamOutlet final : public Outlet {
 public:
  // Calls `wake` when there are results, or when the connection has changed. `name` is shown by the
  // server. `in_flight`: the most messages without a result.
  JetStreamOutlet(const JetStreamSpec& spec, std::string name, std::uint32_t in_flight,
                  std::function<void()> wake);
  // Waits for the threads of the library.
  ~JetStreamOutlet() override;

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] bool send(const OutletMessage& message) override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::forward
