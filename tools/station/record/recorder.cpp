#include "tools/station/record/recorder.hpp"

#include <algorithm>
#include <utility>

#include "core/base/time.hpp"

namespace fieldcast::web {

namespace {

// The times are untrusted network data: any 64-bit number.
Duration between(UtcTime from, UtcTime to) {
  return Duration{saturated_difference(to.nanoseconds, from.nanoseconds)};
}
UtcTime operator-(UtcTime time, Duration by) {
  return {saturated_difference(time.nanoseconds, by.count())};
}

}  // namespace

void ClockOffset::note(UtcTime acquired, UtcTime received) {
  const Duration offset = between(acquired, received);
  if (offset > SampleStamp::kMaxOffset || offset < -SampleStamp::kMaxOffset) return;
  const Duration age = between(window_began_, received);
  if (age >= kWindow || age < Duration{}) {
    before_ = age < 2 * kWindow ? now_ : std::nullopt;
    now_.reset();
    window_began_ = received;
  }
  now_ = now_ ? std::min(*now_, offset) : offset;
}

Duration ClockOffset::least() const {
  if (before_ && now_) return std::min(*before_, *now_);
  return before_.value_or(now_.value_or(Duration{}));
}

std::optional<UtcTime> SampleStamp::next(const StationSample& sample, UtcTime received,
                                         Duration offset, bool first) {
  if (any_ && sample.sequence == sequence_ && sample.acquired_at == acquired_ &&
      sample.quality == quality_)
    return std::nullopt;
  const Duration age = between(sample.acquired_at, received);
  const bool by_acquisition = sample.quality == Quality::kGood && age >= -kMaxOffset &&
                              age <= (first ? kOldest : kMaxOffset);
  UtcTime published = by_acquisition ? sample.acquired_at : received - offset;
  if (any_ && published <= published_ && between(published, published_) < kOrder)
    published = UtcTime{saturated_sum(published_.nanoseconds, 1)};
  any_ = true;
  sequence_ = sample.sequence;
  acquired_ = sample.acquired_at;
  quality_ = sample.quality;
  return published_ = published;
}

namespace {

AlarmRecord record_of(const AlarmKey& key, AlarmState state, double value, UtcTime since) {
  return {.bus = key.bus,
          .device = key.device,
          .channel = key.channel,
          .limit = std::string(to_text(key.limit)),
          .state = std::string(to_text(state)),
          .value = value,
          .since = since};
}

}  // namespace

AlarmNews AlarmDiff::next(const StationAlarmStatus& alarm, UtcTime received) {
  AlarmNews news;
  const auto known = known_.find(alarm.alarm);
  if (known == known_.end() && known_.size() >= kMaxAlarms) return news;
  AlarmStatus& before = known == known_.end() ? known_[alarm.alarm] : known->second;
  if (before == alarm.status) return news;
  compare(alarm.alarm, before, alarm.status, received, news);
  before = alarm.status;
  news.kept.push_back({alarm.alarm, alarm.status});
  return news;
}

void AlarmDiff::compare(const AlarmKey& key, const AlarmStatus& before, const AlarmStatus& now,
                        UtcTime received, AlarmNews& news) {
  if (now.raised_at != before.raised_at && now.raised_at.nanoseconds != 0)
    news.records.push_back(record_of(key, AlarmState::kActive, now.value, now.raised_at));
  if (!now.active && now.cleared_at != before.cleared_at && now.cleared_at.nanoseconds != 0)
    news.records.push_back(record_of(key, AlarmState::kClear, now.value, now.cleared_at));
  if (now.acknowledged != before.acknowledged && now.acknowledged.at.nanoseconds != 0) {
    news.events.push_back({.at = now.acknowledged.at,
                           .alarm = key,
                           .kind = AlarmEventKind::kAcknowledged,
                           .by = now.acknowledged.by,
                           .note = now.acknowledged.note});
  }
  compare_shelving(key, before.shelved, now.shelved, received, news);
  compare_maintenance(key, now.suppressed, received, news);
}

void AlarmDiff::compare_shelving(const AlarmKey& key, const AlarmPause& before,
                                 const AlarmPause& now, UtcTime received, AlarmNews& news) {
  if (now == before) return;
  if (now.is_set()) {
    news.events.push_back({.at = now.since,
                           .alarm = key,
                           .kind = AlarmEventKind::kShelved,
                           .by = now.by,
                           .note = now.note,
                           .until = now.until});
  } else if (before.until <= received) {
    news.events.push_back(
        {.at = before.until, .alarm = key, .kind = AlarmEventKind::kShelvingEnded});
  } else {
    news.events.push_back({.at = received, .alarm = key, .kind = AlarmEventKind::kUnshelved});
  }
}

void AlarmDiff::compare_maintenance(const AlarmKey& key, const AlarmPause& now, UtcTime received,
                                    AlarmNews& news) {
  const AlarmDevice device{key.bus, key.device};
  const auto known = maintenance_.find(device);
  const AlarmPause before = known == maintenance_.end() ? AlarmPause{} : known->second;
  if (now == before) return;
  AlarmEvent event{.alarm = {.bus = key.bus, .device = key.device}};
  if (now.is_set()) {
    maintenance_[device] = now;
    event.at = now.since;
    event.kind = AlarmEventKind::kMaintenance;
    event.by = now.by;
    event.note = now.note;
    event.until = now.until;
  } else {
    maintenance_.erase(device);
    event.at = std::min(before.until, received);
    event.kind = AlarmEventKind::kMaintenanceEnded;
  }
  news.events.push_back(std::move(event));
  news.maintenance.push_back({device, now});
}

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
    note(*to, sample, row.published_at);
    // Within the lock, so that rows of a channel are queued in order.
    store_.put(std::span(&row, 1));
  }
}

void Recorder::watch_gaps() {
  const std::lock_guard lock(mutex_);
  watches_gaps_ = true;
}

Recorder::Gaps Recorder::take_gaps() {
  const std::lock_guard lock(mutex_);
  return std::exchange(gaps_, {});
}

void Recorder::note(Channel& channel, const StationSample& sample, UtcTime published) {
  const SampleNumber number{sample.epoch, sample.sequence};
  const SampleNumber last = std::exchange(channel.last, number);
  if (!watches_gaps_ || number.epoch == 0 || gaps_.gaps.size() + gaps_.first.size() >= kMaxGaps)
    return;
  std::string path = path_of(sample.bus, sample.device, sample.channel);
  if (last.epoch == 0) {
    gaps_.first.push_back({std::move(path), number, published});
  } else if (is_gap(last, number)) {
    gaps_.gaps.push_back({std::move(path), last, number, {}});
  }
}

void Recorder::on_fetched(const std::string& path, const HistoryRow& fetched) {
  const std::lock_guard lock(mutex_);
  const auto known = channels_.find(path);
  if (known == channels_.end() || !known->second.number) return;
  const Duration late = between(fetched.acquired_at, fetched.published_at);
  // As SampleStamp, so that a sample that arrived too is stored once.
  const bool by_acquisition = fetched.quality == Quality::kGood &&
                              late >= -SampleStamp::kMaxOffset && late <= SampleStamp::kMaxOffset;
  const SampleRow row{.channel = *known->second.number,
                      .published_at = by_acquisition ? fetched.acquired_at : fetched.published_at,
                      .acquired_at = fetched.acquired_at,
                      .sequence = fetched.number.sequence,
                      .quality = fetched.quality,
                      .device_code = fetched.device_code,
                      .value = fetched.value};
  ++counters_.recorded;
  store_.put(std::span(&row, 1));
}

void Recorder::on_device_status(const StationDeviceStatus& status, UtcTime received) {
  const std::lock_guard lock(mutex_);
  std::string name = status.bus + '/' + status.device;
  auto known = devices_.find(name);
  const bool is_new = known == devices_.end();
  if (is_new) {
    if (devices_.size() >= kMaxDevices) return;
    known = devices_.emplace(std::move(name), Device{}).first;
    known->second.number = store_.number_of({.bus = status.bus,
                                             .device = status.device,
                                             .channel = kResponseTime,
                                             .unit = "ms",
                                             .type = "float64"});
  }
  put_response_time(status, received, known->second);
  if (!is_new && known->second.state == status.report.state) return;
  known->second.state = status.report.state;
  store_.put(DeviceRecord{.bus = status.bus,
                          .device = status.device,
                          .state = std::string(to_text(status.report.state)),
                          .since = status.reported_at});
}

void Recorder::put_response_time(const StationDeviceStatus& status, UtcTime received,
                                 Device& device) {
  constexpr std::int64_t kMinute = 60'000'000'000;
  const DeviceReport& report = status.report;
  const bool is_offline = report.state == DeviceState::kOffline;
  // By the clock of the bridge, so that a second recorder stores the same row.
  const Duration late = between(status.reported_at, received);
  const bool is_near = late <= SampleStamp::kMaxOffset && late >= -SampleStamp::kMaxOffset;
  const UtcTime at = is_near ? status.reported_at : received;
  const std::int64_t minute = at.nanoseconds / kMinute;
  if (!device.number || minute == device.minute ||
      (!is_offline && report.response_time <= Duration::zero()))
    return;
  device.minute = minute;
  const SampleRow row{.channel = *device.number,
                      .published_at = at,
                      .acquired_at = at,
                      .sequence = static_cast<std::uint64_t>(minute),
                      .quality = is_offline ? Quality::kBadNoResponse : Quality::kGood,
                      .value = to_seconds(report.response_time) * 1e3,
                      .perhaps_stored = true};
  store_.put(std::span(&row, 1));
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
