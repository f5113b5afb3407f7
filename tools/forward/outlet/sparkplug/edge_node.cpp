#include "tools/forward/outlet/sparkplug/edge_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bridge/log/log.hpp"
#include "core/base/message_text.hpp"
#include "tools/forward/outlet/mqtt/topics.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

constexpr std::string_view kNamespace = "spBv1.0";
constexpr std::string_view kBirthAndDeath = "bdSeq";

Metric birth_and_death(std::uint8_t number, UtcTime now) {
  return {.name = std::string(kBirthAndDeath),
          .at = now,
          .type = MetricType::kInt64,
          .value = Value(std::int64_t{number})};
}

std::array<std::optional<double>, 4> limits_of(const StationChannel& channel) {
  const Limits& limits = channel.limits;
  return {limits.low_low, limits.low, limits.high, limits.high_high};  // as LimitKind
}

std::string alarm_name(const std::string& channel, std::size_t limit) {
  return fmt::format("Alarms/{}/{}", channel, to_text(static_cast<LimitKind>(limit)));
}

// A device sent something.
bool is_response(Quality quality) {
  switch (quality) {
    case Quality::kGood:
    case Quality::kBadFrame:
    case Quality::kBadDeviceError:
    case Quality::kBadRange: return true;
    default: return false;
  }
}

void log_unknown(const Record& record, const char* what) {
  log_counted(LogLevel::kWarning, "sparkplug", "records of removed channels",
              fmt::format("{}/{}: {} of a channel that the device no longer has; not sent",
                          record.bus, record.device, what));
}

}  // namespace

EdgeNode::EdgeNode(const SparkplugSpec& spec, const std::string& site,
                   RecordDecoder::FindCatalogue catalogue)
    : spec_(spec),
      node_(topic_level(spec.edge_node.empty() ? site : spec.edge_node)),
      decoder_(std::move(catalogue)) {}

std::string EdgeNode::node_topic(std::string_view type) const {
  return fmt::format("{}/{}/{}/{}", kNamespace, topic_level(spec_.group), type, node_);
}

MqttMessage EdgeNode::will(std::uint64_t number, UtcTime now) {
  bd_seq_ = static_cast<std::uint8_t>(number);
  return death(now);
}

MqttMessage EdgeNode::death(UtcTime now) const {
  // The specification requires QoS 1 for this message only.
  return {node_topic("NDEATH"),
          encode_payload({birth_and_death(bd_seq_, now)}, std::nullopt, now, true), 1, false};
}

MqttMessage EdgeNode::made(std::string_view type, const Device* device,
                           const std::vector<Metric>& metrics, UtcTime now) {
  const bool is_birth = type.ends_with("BIRTH"), is_data = type.ends_with("DATA");
  std::string topic = node_topic(type);
  if (device != nullptr) topic += '/' + device->id;
  return {std::move(topic), encode_payload(metrics, next_seq_++, now, is_birth),
          is_data ? static_cast<int>(spec_.qos) : 0, false};
}

std::vector<MqttMessage> EdgeNode::births(UtcTime now) {
  next_seq_ = 0;
  Messages messages;
  messages.push_back(made("NBIRTH", nullptr,
                          {birth_and_death(bd_seq_, now),
                           {.name = std::string(kRebirth),
                            .at = now,
                            .type = MetricType::kBoolean,
                            .value = Value(false)}},
                          now));
  for (auto& [name, device] : devices_) {
    device.is_born = false;
    if (!device.channels.empty() && !device.is_dead) bear(device, messages, now);
  }
  return messages;
}

void EdgeNode::bear(Device& device, Messages& messages, UtcTime now) {
  std::vector<Metric> metrics;
  for (Channel& channel : device.channels) {
    const Last last = channel.last.value_or(Last{.value = {}, .at = now});
    channel.was_good = last.quality == Quality::kGood;
    Metric& metric = metrics.emplace_back();
    metric = {
        .name = channel.entry.channel,
        .alias = channel.alias,
        .at = last.at,
        .type = channel.type,
        .quality = last.quality,
        .channel = &channel.entry,
        .is_writable = !spec_.command_user.empty() && channel.entry.access != Access::kReadOnly};
    if (has_value(last.quality)) metric.value = last.value;
    for (std::size_t limit = 0; limit < channel.alarms.size(); ++limit) {
      const Alarm& alarm = channel.alarms[limit];
      if (alarm.alias == 0) continue;
      Metric& state = metrics.emplace_back();
      state = {.name = alarm_name(channel.entry.channel, limit),
               .alias = alarm.alias,
               .at = alarm.is_active ? alarm.at : now,
               .type = MetricType::kBoolean};
      if (alarm.is_active) state.value = Value(*alarm.is_active);
    }
  }
  messages.push_back(made("DBIRTH", &device, metrics, now));
  device.is_born = true;
  device.born_at = now;
  device.is_dead = false;
}

std::vector<EdgeNode::Write> EdgeNode::writes(const MqttMessage& message) const {
  const auto refused = [](std::string reason) {
    return std::vector<Write>{tl::make_unexpected(std::move(reason))};
  };
  const auto command = decode_command(message.payload);
  if (!command) return refused("the payload cannot be decoded");
  const std::string id = message.topic.substr(message.topic.rfind('/') + 1);
  const auto found = std::ranges::find_if(
      devices_, [&id](const auto& each) { return each.second.id == id && each.second.is_born; });
  if (found == devices_.end()) return refused("no such device is born");
  if (command->at.nanoseconds == 0) return refused("the payload has no timestamp");
  // A host could otherwise use the aliases of an earlier birth for other channels.
  if (command->at < found->second.born_at)
    return refused("the command is older than the birth of the device; send it again");
  std::vector<Write> writes;
  for (const CommandMetric& metric : command->metrics) {
    writes.push_back(write_of(found->second, *command, metric));
    if (!writes.back()) continue;
    writes.back()->id =
        fmt::format("{}-{:016x}-{}", command->at.nanoseconds / 1'000'000,
                    std::hash<std::string>{}(message.topic + message.payload), writes.size());
  }
  return writes;
}

EdgeNode::Write EdgeNode::write_of(const Device& device, const HostCommand& command,
                                   const CommandMetric& metric) const {
  const auto refused = [&metric](std::string_view why) {
    return tl::make_unexpected(fmt::format("{}: {}", printable(metric.text(), 64), why));
  };
  const auto channel = std::ranges::find_if(device.channels, [&metric](const Channel& each) {
    return metric.name.empty() ? metric.alias == each.alias : metric.name == each.entry.channel;
  });
  if (channel == device.channels.end()) return refused("the device has no such channel");
  auto value = value_of(metric, channel->type);
  if (!value) return refused("the value is null or not of the type of the metric");
  const StationChannel& entry = channel->entry;
  return CommandRequest{.user = spec_.command_user,
                        .channel = {entry.bus, entry.device, entry.channel},
                        .value = *std::move(value),
                        .verify = entry.access == Access::kReadWrite,
                        .expires_at = {command.at.nanoseconds + kCommandLife.count()}};
}

std::optional<EdgeNode::Messages> EdgeNode::messages(const Record& record, UtcTime now) {
  switch (record.kind) {
    case RecordKind::kCatalogue: return catalogue(record);
    case RecordKind::kAlarm: return alarm(record, now);
    case RecordKind::kAudit: return Messages{};  // Sparkplug has no place for it
    case RecordKind::kSamples: break;
  }
  return samples(record, now);
}

EdgeNode::Device& EdgeNode::device_of(const Record& record) {
  Device& device = devices_[{record.bus, record.device}];
  if (device.id.empty())
    device.id = fmt::format("{}:{}", topic_level(record.bus), topic_level(record.device));
  return device;
}

std::uint64_t EdgeNode::alias_of(const std::string& metric) {
  return aliases_.try_emplace(metric, aliases_.size() + 1).first->second;
}

void EdgeNode::set_catalogue(Device& device, const DeviceCatalogue& catalogue,
                             std::uint64_t identity, std::uint64_t record) {
  std::vector<Channel> before = std::exchange(device.channels, {});
  const auto index_before = std::exchange(device.index, {});
  for (const StationChannel& entry : catalogue.channels) {
    Channel channel;
    const auto known = index_before.find(entry.channel);
    if (known != index_before.end()) channel = std::move(before[known->second]);
    const bool is_same_type = channel.entry.type == entry.type;
    channel.entry = entry;
    channel.alias = alias_of(entry.path());
    if (!is_same_type) {
      channel.type = metric_type_of(entry.type);
      channel.last.reset();
    }
    const auto limits = limits_of(entry);
    for (std::size_t limit = 0; limit < limits.size(); ++limit)
      channel.alarms[limit].alias =
          limits[limit] ? alias_of(fmt::format("{} {}", entry.path(), limit)) : 0;
    device.index[entry.channel] = device.channels.size();
    device.channels.push_back(std::move(channel));
  }
  for (const auto& [name, status] : std::exchange(device.early_alarms, {})) {
    const auto found = device.index.find(name.first);
    if (found == device.index.end()) continue;
    Alarm& alarm = device.channels[found->second].alarms[name.second];
    alarm.is_active = status.active;
    alarm.at = status.since();
  }
  device.catalogue = identity;
  device.record = record;
  device.is_born = false;
}

// DBIRTH is sent with the next samples of the device, so that it contains their types.
std::optional<EdgeNode::Messages> EdgeNode::catalogue(const Record& record) {
  const auto decoded = decode_catalogue(record.body);
  if (!decoded) return std::nullopt;
  Device& device = device_of(record);
  // A catalogue of the backlog does not replace a newer one.
  if (record.id > device.record) {
    if (device.catalogue == record.identity && !device.channels.empty()) {
      device.record = record.id;
    } else {
      set_catalogue(device, *decoded, record.identity, record.id);
    }
  }
  return Messages{};
}

std::vector<EdgeNode::Channel*> EdgeNode::channels_of(Device& device,
                                                      const RecordDecoder::Samples& samples) {
  const auto& entries = samples.catalogue->channels;
  std::vector<Channel*> channels;
  for (const BatchSample& sample : samples.batch.samples) {
    const auto found = sample.channel < entries.size()
                           ? device.index.find(entries[sample.channel].channel)
                           : device.index.end();
    Channel* const channel =
        found == device.index.end() ? nullptr : &device.channels[found->second];
    channels.push_back(channel);
    if (channel == nullptr || !has_value(sample.quality) || fits(channel->type, sample.value))
      continue;
    channel->type = widest_type_of(sample.value);
    if (channel->last && !fits(channel->type, channel->last->value)) channel->last.reset();
    device.is_born = false;  // DBIRTH declares the new type
  }
  return channels;
}

Metric EdgeNode::metric_of(Channel& channel, const BatchSample& sample, bool is_late) {
  Metric metric{.name = {},
                .alias = channel.alias,
                .at = sample.acquired_at,
                .type = channel.type,
                .is_historical = is_late};
  const bool is_good = sample.quality == Quality::kGood;
  // A value of another type in the same batch is not representable: the metric is null.
  if (has_value(sample.quality) && fits(channel.type, sample.value)) metric.value = sample.value;
  if (!is_good || (!is_late && !channel.was_good)) metric.quality = sample.quality;
  if (!is_late) {
    channel.was_good = is_good;
    channel.last = Last{sample.value, sample.quality, sample.acquired_at};
  }
  return metric;
}

std::optional<EdgeNode::Messages> EdgeNode::samples(const Record& record, UtcTime now) {
  auto decoded = decoder_.samples(record);
  if (!decoded) return std::nullopt;
  Device& device = device_of(record);
  const bool is_newer = !record.is_late && record.id > device.record;
  if (device.channels.empty() || (is_newer && device.catalogue != decoded->batch.catalogue))
    set_catalogue(device, *decoded->catalogue, decoded->batch.catalogue, record.id);
  // The payload is in the order of time (5.9); the batch is in the order of the channels.
  std::stable_sort(
      decoded->batch.samples.begin(), decoded->batch.samples.end(),
      [](const BatchSample& a, const BatchSample& b) { return a.acquired_at < b.acquired_at; });
  const std::vector<Channel*> channels = channels_of(device, *decoded);
  const auto& batch = decoded->batch.samples;
  if (device.is_dead && !record.is_late &&
      std::none_of(batch.begin(), batch.end(),
                   [](const BatchSample& sample) { return is_response(sample.quality); }))
    return Messages{};
  Messages messages;
  if (!device.is_born) bear(device, messages, now);
  std::vector<Metric> metrics;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (channels[i] == nullptr) {
      log_unknown(record, "a sample");
      continue;
    }
    metrics.push_back(metric_of(*channels[i], batch[i], record.is_late));
  }
  if (!metrics.empty()) messages.push_back(made("DDATA", &device, metrics, now));
  if (is_silent(device)) die(device, messages, now);
  return messages;
}

// A channel without a refresh, for example a write-only one, may never have a sample.
bool EdgeNode::is_silent(const Device& device) {
  const auto may_respond = [](const Channel& channel) {
    return channel.last ? is_response(channel.last->quality) : channel.entry.refresh > Duration{};
  };
  const auto is_without_response = [](const Channel& channel) {
    return channel.last && channel.last->quality == Quality::kBadNoResponse;
  };
  return std::ranges::none_of(device.channels, may_respond) &&
         std::ranges::any_of(device.channels, is_without_response);
}

void EdgeNode::die(Device& device, Messages& messages, UtcTime now) {
  messages.push_back(made("DDEATH", &device, {}, now));
  device.is_born = false;
  device.is_dead = true;
}

std::vector<MqttMessage> EdgeNode::deaths(const IsAnnounced& is_announced, UtcTime now) {
  Messages messages;
  for (auto& [name, device] : devices_) {
    if (!device.is_born || is_announced(name.first, name.second)) continue;
    die(device, messages, now);
    for (Channel& channel : device.channels) {  // the next birth does not show them as good
      if (channel.last && channel.last->quality == Quality::kGood)
        channel.last->quality = Quality::kUncertain;
    }
  }
  return messages;
}

std::optional<EdgeNode::Messages> EdgeNode::alarm(const Record& record, UtcTime now) {
  const auto decoded = decode_alarm(record.body);
  if (!decoded) return std::nullopt;
  Device& device = device_of(record);
  const auto found = device.index.find(decoded->alarm.channel);
  const auto limit = static_cast<std::size_t>(decoded->alarm.limit);
  if (device.channels.empty() && device.early_alarms.size() < kMostEarly) {
    device.early_alarms[{decoded->alarm.channel, limit}] = decoded->status;
    return Messages{};
  }
  if (found == device.index.end() || device.channels[found->second].alarms[limit].alias == 0) {
    log_unknown(record, "an alarm");
    return Messages{};
  }
  Alarm& alarm = device.channels[found->second].alarms[limit];
  alarm.is_active = decoded->status.active;
  alarm.at = decoded->status.since();
  Messages messages;
  // Otherwise the next DBIRTH contains the state.
  if (device.is_born)
    messages.push_back(made("DDATA", &device,
                            {{.name = {},
                              .alias = alarm.alias,
                              .at = alarm.at,
                              .type = MetricType::kBoolean,
                              .value = Value(*alarm.is_active)}},
                            now));
  return messages;
}

}  // namespace fieldcast::forward
