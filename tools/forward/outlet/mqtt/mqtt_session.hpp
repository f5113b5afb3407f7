// Keeps a connection to one of the servers: opens it, tries the next server after a loss, and ends
// it if an acknowledgement is missing. Matches acknowledgements to records. One owner, one thread.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/forward/outlet/mqtt/deliveries.hpp"
#include "tools/forward/outlet/mqtt/mqtt_client.hpp"

namespace fieldcast::forward {

class MqttSession {
 public:
  struct Handlers {
    std::function<std::optional<MqttMessage>()> will;  // called for each attempt
    std::function<void(const MqttMessage&)> received;  // called by look()
  };
  // `section` is the name of the configuration's section, for the log.
  MqttSession(const MqttServers& spec, std::string section, const OutletContext& context,
              Handlers handlers);

  // Opens a connection if there is none, and handles events. Returns true if it is open.
  [[nodiscard]] bool look(Instant now);
  // Handles acknowledgements and received messages.
  void handle_events(Instant now);
  // Numbers the connections that were open; 0: none yet.
  [[nodiscard]] std::uint64_t number() const { return number_; }

  // False while too many messages wait for an acknowledgement.
  [[nodiscard]] bool has_space() const { return deliveries_.messages() < kMostMessages; }

  // Every record: begin(), its messages, end(). Then it has a result when all its messages with
  // QoS 1 are acknowledged.
  void begin(std::uint64_t record) { deliveries_.begin(record); }
  // The message may belong to no record. A message that is too large counts as refused. Returns
  // false if the connection was lost; then the record has failed.
  [[nodiscard]] bool publish(const MqttMessage& message, std::optional<std::uint64_t> record,
                             Instant now);
  void end(std::uint64_t record) { deliveries_.end(record, results_); }
  // As end(), when the server has processed everything before. For messages with QoS 0.
  void end_confirmed(const std::vector<std::uint64_t>& records, Instant now);
  // The result of a record without messages.
  void finish(std::uint64_t record, Outcome outcome) { results_.push_back({record, outcome}); }
  [[nodiscard]] bool subscribe(const std::string& filter) {
    return client_ && client_->subscribe(filter);
  }

  // Ends the connection, with its will. The next attempt uses the next server after a pause.
  void reconnect(const std::string& reason, Instant now);
  // As close(), and then as reconnect().
  void restart(const std::optional<MqttMessage>& last, bool publish_will, const std::string& reason,
               Instant now);
  // Ends the connection in order after `last` and pending acknowledgements, if it is open. Blocks
  // at most two seconds.
  void close(const std::optional<MqttMessage>& last, bool publish_will);

  [[nodiscard]] std::vector<OutletResult> take_results();

 private:
  // One record may exceed it. The library visits all pending messages for each acknowledgement.
  static constexpr std::size_t kMostMessages = 1'000;

  void open();
  void on_acknowledged(const MqttEvent& event, Instant now);
  void wait_for_acknowledgements();
  void drop(Instant now);

  const MqttServers spec_;
  const std::string section_, client_id_;
  const std::function<void()> wake_;
  const Handlers handlers_;
  std::unique_ptr<MqttClient> client_;
  std::size_t server_ = 0;  // of the present or next attempt
  bool was_open_ = false;
  std::uint64_t number_ = 0;
  Instant next_attempt_{};
  Deliveries deliveries_;
  std::vector<OutletResult> results_;
};

}  // namespace fieldcast::forward
