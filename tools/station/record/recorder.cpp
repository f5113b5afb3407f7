#include "tools/station/record/recorder.hpp"

#include <utility>

namespace fieldcast::web {
namespace {

std::string path_of(const std::string& bus, const std::string& device, const std::string& channel) {
  std::string path;
  path.reserve(bus.size() + device.size() + channel.size() + 2);
  return path.append(bus).append(1, '/').append(device).append(1, '/').append(channel);
}

// Type as stored by a bridge: "string(16)" becomes "string".
std::string stored_type(const std::string& type) { return type.substr(0, type.find('(')); }

}  // namespace

Recorder::Channel* Recorder::channel(std::string path) {
  const auto known = channels_.find(path);
  if (known != channels_.end()) return &known->second;
  if (channels_.size() >= kMaxChannels)
    std::erase_if(channels_, [](const auto& entry) { return entry.second.gone; });
  if (channels_.size() >= kMaxChannels) return nullptr;
  return &channels_[std::move(path)];
}

void Recorder::on_channel(const StationChannel& from) {
  const std::lock_guard lock(mutex_);
  Channel* const to = channel(path_of(from.bus, from.device, from.channel));
  if (to == nullptr) return;
  to->number = store_.number_of({.bus = from.bus,
                                 .device = from.device,
                                 .channel = from.channel,
                                 .unit = from.unit,
                                 .type = stored_type(from.type)});
  to->told = true;
  to->gone = false;
}

void Recorder::on_gone(const std::string& bus, const std::string& device,
                       const std::string& channel) {
  const std::lock_guard lock(mutex_);
  const auto known = channels_.find(path_of(bus, device, channel));
  if (known == channels_.end()) return;
  known->second.gone = true;
  known->second.is_new = true;
}

void Recorder::on_sample(const StationSample& sample, UtcTime received) {
  SampleRow row;
  {
    const std::lock_guard lock(mutex_);
    Channel* const to = channel(path_of(sample.bus, sample.device, sample.channel));
    if (to == nullptr) {
      ++counters_.unknown;
      return;
    }
    if (!std::exchange(to->told, true)) {
      to->number =
          store_.number_of({.bus = sample.bus, .device = sample.device, .channel = sample.channel});
    }
    if (!to->number) return;
    ClockOffset& clock = clocks_[sample.bus];
    const bool first = std::exchange(to->is_new, false);
    // The first sample of a returned channel is its last value and does not show the delay.
    if (sample.quality == Quality::kGood && !first) clock.note(sample.acquired_at, received);
    const auto published = to->stamp.next(sample, received, clock.least(), first);
    if (!published) {
      ++counters_.repeated;
      return;
    }
    ++counters_.recorded;
    row = {.channel = *to->number,
           .published_at = *published,
           .acquired_at = sample.acquired_at,
           .sequence = sample.sequence,
           .quality = sample.quality,
           .device_code = sample.device_code,
           .value = sample.value,
           .perhaps_stored = first};
    // Within the lock, so that rows of a channel are queued in order.
    store_.put(std::span(&row, 1));
  }
}

void Recorder::on_device_status(const StationDeviceStatus& status) {
  const std::lock_guard lock(mutex_);
  std::string name = status.bus + '/' + status.device;
  const auto known = devices_.find(name);
  if (known != devices_.end() && known->second == status.report.state) return;
  if (known == devices_.end() && devices_.size() >= kMaxDevices) return;
  devices_[std::move(name)] = status.report.state;
  store_.put(DeviceRecord{.bus = status.bus,
                          .device = status.device,
                          .state = std::string(to_text(status.report.state)),
                          .since = status.reported_at});
}

void Recorder::on_alarm_status(const StationAlarmStatus& status, UtcTime received) {
  const std::lock_guard lock(mutex_);
  AlarmNews news = alarms_.next(status, received);
  for (AlarmRecord& record : news.records) store_.put(std::move(record));
  for (AlarmEvent& event : news.events) store_.put(std::move(event));
  for (KeptAlarm& kept : news.kept) store_.put(std::move(kept));
  for (KeptMaintenance& kept : news.maintenance) store_.put(std::move(kept));
}

Recorder::Counters Recorder::counters() const {
  const std::lock_guard lock(mutex_);
  Counters counters = counters_;
  counters.channels = channels_.size();
  return counters;
}

}  // namespace fieldcast::web
