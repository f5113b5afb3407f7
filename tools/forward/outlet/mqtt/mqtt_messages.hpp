// The messages of a record as plain MQTT. Pure; one owner.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/forward/outlet/mqtt/mqtt_client.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

class MqttMessages {
 public:
  MqttMessages(const MqttSpec& spec, std::string site, RecordDecoder::FindCatalogue catalogue)
      : spec_(spec), site_(std::move(site)), decoder_(std::move(catalogue)) {}

  // In their order. Empty if the record cannot be decoded.
  [[nodiscard]] std::optional<std::vector<MqttMessage>> of(const Record& record);
  // "online" or "offline" of this site, retained.
  [[nodiscard]] MqttMessage status(bool is_online) const;
  // "online" or "offline" of each device of earlier records whose announcement has changed since
  // the last call, retained. With `all`, of each device.
  [[nodiscard]] std::vector<MqttMessage> device_status(const IsAnnounced& is_announced, bool all);
  // The state of the forwarder, retained.
  [[nodiscard]] MqttMessage site(const SiteStatus& status) const;

 private:
  [[nodiscard]] std::optional<std::vector<MqttMessage>> samples(const Record& record);
  [[nodiscard]] std::optional<std::vector<MqttMessage>> catalogue(const Record& record);
  [[nodiscard]] std::optional<std::vector<MqttMessage>> alarm(const Record& record) const;
  [[nodiscard]] std::optional<std::vector<MqttMessage>> audit(const Record& record) const;

  const MqttSpec spec_;
  const std::string site_;
  RecordDecoder decoder_;
  // By bus and device: whether it was announced at the last device_status(). Empty: not published.
  std::map<std::pair<std::string, std::string>, std::optional<bool>> devices_;
  // Topics of discovery, by bus and device: those of removed channels are cleared.
  std::map<std::pair<std::string, std::string>, std::set<std::string>> discovered_;
};

}  // namespace fieldcast::forward
