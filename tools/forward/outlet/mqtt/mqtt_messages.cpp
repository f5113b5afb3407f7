#include "tools/forward/outlet/mqtt/mqtt_messages.hpp"

#include <utility>

#include "core/base/json.hpp"
#include "tools/forward/outlet/mqtt/discovery.hpp"
#include "tools/forward/outlet/mqtt/topics.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {

namespace {

std::string payload_of(const BatchSample& sample, const StationChannel& channel,
                       const std::string& epoch) {
  Json json{{"value", sample.value},
            {"quality", to_text(sample.quality)},
            {"acquired_at", sample.acquired_at.nanoseconds},
            {"unit", channel.unit},
            {"epoch", epoch},
            {"sequence", sample.sequence}};
  if (sample.device_code != 0) json.add("device_code", sample.device_code);
  return json.text();
}

}  // namespace

MqttMessage MqttMessages::status(bool is_online) const {
  return {status_topic(spec_.prefix, site_), is_online ? "online" : "offline", 1, true};
}

std::vector<MqttMessage> MqttMessages::device_status(const IsAnnounced& is_announced, bool all) {
  std::vector<MqttMessage> messages;
  for (auto& [name, known] : devices_) {
    const auto& [bus, device] = name;
    const bool is_online = is_announced(bus, device);
    if (std::exchange(known, is_online) == is_online && !all) continue;
    messages.push_back({device_status_topic(spec_.prefix, site_, bus, device),
                        is_online ? "online" : "offline", 1, true});
  }
  return messages;
}

MqttMessage MqttMessages::site(const SiteStatus& status) const {
  return {site_topic(spec_.prefix, site_), to_json(status), 1, true};
}

std::optional<std::vector<MqttMessage>> MqttMessages::of(const Record& record) {
  switch (record.kind) {
    case RecordKind::kCatalogue: return catalogue(record);
    case RecordKind::kAlarm: return alarm(record);
    case RecordKind::kAudit: return audit(record);
    case RecordKind::kSamples: break;
  }
  devices_.try_emplace({record.bus, record.device});
  return samples(record);
}

// A late sample is not the last value of its channel: it is never retained.
std::optional<std::vector<MqttMessage>> MqttMessages::samples(const Record& record) {
  const auto decoded = decoder_.samples(record);
  if (!decoded) return std::nullopt;
  const std::vector<StationChannel>& channels = decoded->catalogue->channels;
  const std::string topics = sample_topics(spec_.prefix, site_, record) + '/';
  const std::string epoch = hex_text(decoded->batch.epoch);
  std::vector<MqttMessage> messages;
  messages.reserve(decoded->batch.samples.size());
  for (const BatchSample& sample : decoded->batch.samples) {
    if (sample.channel >= channels.size()) continue;
    const StationChannel& channel = channels[sample.channel];
    messages.push_back({topics + topic_level(channel.channel), payload_of(sample, channel, epoch),
                        1, spec_.retain && !record.is_late});
  }
  return messages;
}

std::optional<std::vector<MqttMessage>> MqttMessages::catalogue(const Record& record) {
  const auto decoded = decode_catalogue(record.body);
  if (!decoded) return std::nullopt;
  std::vector<MqttMessage> messages{
      {catalogue_topic(spec_.prefix, site_, record), to_json(site_, *decoded), 1, spec_.retain}};
  if (!spec_.discovery) return messages;
  std::set<std::string> topics;
  for (MqttMessage& message : discovery_messages(spec_, site_, *decoded)) {
    topics.insert(message.topic);
    messages.push_back(std::move(message));
  }
  auto& known = discovered_[{record.bus, record.device}];
  // An empty message removes the channel from Home Assistant.
  for (const std::string& topic : known) {
    if (!topics.contains(topic)) messages.push_back({topic, "", 1, true});
  }
  known = std::move(topics);
  return messages;
}

std::optional<std::vector<MqttMessage>> MqttMessages::audit(const Record& record) const {
  const auto decoded = decode_audit(record.body);
  if (!decoded) return std::nullopt;
  return std::vector<MqttMessage>{
      {audit_topic(spec_.prefix, site_, decoded->bridge), to_json(site_, *decoded), 1, false}};
}

std::optional<std::vector<MqttMessage>> MqttMessages::alarm(const Record& record) const {
  const auto decoded = decode_alarm(record.body);
  if (!decoded) return std::nullopt;
  return std::vector<MqttMessage>{{alarm_topic(spec_.prefix, site_, decoded->alarm),
                                   to_json(site_, *decoded), 1, spec_.retain}};
}

}  // namespace fieldcast::forward
