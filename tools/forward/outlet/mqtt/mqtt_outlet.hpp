// The outlet for plain MQTT: one message for each sample, with QoS 1.
#pragma once

#include <memory>

#include "tools/forward/outlet/mqtt/mqtt_messages.hpp"
#include "tools/forward/outlet/mqtt/mqtt_session.hpp"

namespace fieldcast::forward {

class MqttOutlet final : public Outlet {
 public:
  MqttOutlet(const MqttSpec& spec, OutletContext context);
  ~MqttOutlet() override;

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  void report(const SiteStatus& status) override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  static constexpr Duration kLook = std::chrono::seconds{1};  // for devices without a bridge

  [[nodiscard]] bool publish_all(const std::vector<MqttMessage>& messages);

  const IsAnnounced is_announced_;
  MqttMessages messages_;
  MqttSession session_;
  std::uint64_t announced_ = 0;  // the connection on which "online" was sent
  Instant now_{};                // of the present turn
  Instant next_look_{};
};

}  // namespace fieldcast::forward
