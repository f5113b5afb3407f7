// The outlet for Kafka: an idempotent producer. While the cluster is not reachable, the library
// keeps the messages in flight and repeats them itself, so that the brokers store them once. When
// it has given them up, the outlet connects again, with the files of the login read again.
// Callbacks of the library run in the calls of the sender's thread.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tools/forward/outlet/kafka/kafka_spec.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

class KafkaOutlet final : public Outlet {
 public:
  KafkaOutlet(const KafkaSpec& spec, OutletContext context);
  ~KafkaOutlet() override;

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::forward
