// The outlet for Sparkplug B: the site is an edge node, and each device is a device of it.
#pragma once

#include <vector>

#include "tools/forward/outlet/mqtt/mqtt_session.hpp"
#include "tools/forward/outlet/sparkplug/edge_node.hpp"
#include "tools/forward/outlet/sparkplug/primary_host.hpp"

namespace fieldcast::forward {

class SparkplugOutlet final : public Outlet {
 public:
  SparkplugOutlet(const SparkplugSpec& spec, const OutletContext& context);
  ~SparkplugOutlet() override;

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  void flush() override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  // Without the primary host, the next server is tried after this time.
  static constexpr Duration kHostWait = std::chrono::seconds{5};
  // Between two looks for devices that no bridge announces.
  static constexpr Duration kLook = std::chrono::seconds{1};

  [[nodiscard]] bool begin_connection(Instant now);
  [[nodiscard]] bool has_host(Instant now);
  [[nodiscard]] bool publish_all(const std::vector<MqttMessage>& messages, Instant now);
  [[nodiscard]] std::uint64_t next_number();
  void on_message(const MqttMessage& message);
  void on_state(const MqttMessage& message);
  void on_device_command(const MqttMessage& message);
  // The last message before an orderly end: MQTT 5 publishes the will instead.
  [[nodiscard]] std::optional<MqttMessage> last_message() const;

  const SparkplugSpec spec_;
  const std::function<std::uint64_t()> count_connection_;
  const std::function<void(CentreRequest)> on_command_;
  const IsAnnounced is_announced_;
  std::uint64_t number_ = 0;  // of the present or next connection
  EdgeNode node_;
  MqttSession session_;
  std::uint64_t connection_ = 0;  // number of the connection that is set up
  Instant connected_{};
  PrimaryHost host_;
  bool is_born_ = false;                    // on this connection
  bool rebirth_ = false;                    // requested by a host
  Instant next_look_{};                     // for deaths
  std::vector<std::uint64_t> unconfirmed_;  // records of this turn
  Instant now_{};                           // of the present turn
};

}  // namespace fieldcast::forward
