#include "bridge/alarm/alarm_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

namespace {

AlarmRecord record_of(const AlarmKey& alarm, AlarmState state, double value, UtcTime since) {
  return {alarm.bus,
          alarm.device,
          alarm.channel,
          std::string(to_text(alarm.limit)),
          std::string(to_text(state)),
          value,
          since};
}

}  // namespace

void AlarmTable::expect_store() {
  const std::lock_guard lock(mutex_);
  loading_ = true;
  (void)book_.restore({}, read_clocks().utc);  // the store provides the alarms later
}

void AlarmTable::loaded(AlarmSink& sink, const KeptAlarms& kept) {
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    const UtcTime now = read_clocks().utc;
    sink_ = &sink;
    loading_ = false;
    (void)end(book_.restore(kept, now), now);
    for (const AlarmRecord& record : std::exchange(held_, {})) enter(record, now);
    changed = take_changes();
  }
  version_.fetch_add(1, std::memory_order_release);
  publish(changed);
}

void AlarmTable::loaded(const std::string& bus, const KeptAlarms& kept) {
  {
    const std::lock_guard lock(mutex_);
    // The store is still loading everything, or there is none.
    if (loading_ || sink_ == nullptr) return;
  }
  followed(bus, kept);
}

void AlarmTable::followed(const std::string& bus, const KeptAlarms& kept) {
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    const UtcTime now = read_clocks().utc;
    (void)end(book_.restore(bus, kept, now), now);
    changed = take_changes();
  }
  version_.fetch_add(1, std::memory_order_release);
  publish(changed);
}

void AlarmTable::close(AlarmSink* sink) {
  const std::lock_guard lock(mutex_);
  for (AlarmRecord& record : std::exchange(held_, {})) {
    if (sink) sink->put(std::move(record));
  }
  sink_ = nullptr;
  loading_ = false;
}

void AlarmTable::publish_with(Publish publish) {
  const std::lock_guard lock(publish_mutex_);
  publish_ = std::move(publish);
}

void AlarmTable::publish_again(const std::string& bus) {
  std::set<AlarmKey> known;
  {
    const std::lock_guard lock(mutex_);
    const std::vector<AlarmKey> keys = book_.known_of(bus);
    known.insert(keys.begin(), keys.end());
    for (const auto& [alarm, status] : ended_) {
      if (alarm.bus == bus) known.insert(alarm);
    }
  }
  publish(known);
}

void AlarmTable::publish(const std::set<AlarmKey>& changed) {
  if (changed.empty()) return;
  const std::lock_guard lock(publish_mutex_);
  if (!publish_) return;
  for (const AlarmKey& alarm : changed) publish_(alarm);
}

std::optional<AlarmStatus> AlarmTable::status_of(const AlarmKey& alarm) const {
  const std::lock_guard lock(mutex_);
  const AlarmStatus* status = book_.find(alarm);
  if (status != nullptr) return *status;
  const auto ended = ended_.find(alarm);
  return ended == ended_.end() ? std::nullopt : std::optional(ended->second);
}

std::vector<AlarmRecord> AlarmTable::configure(const std::vector<BusSpec>& buses, UtcTime now) {
  std::vector<AlarmRecord> ended;
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(ended_, [&](const auto& each) {
      return book_.find(each.first) != nullptr ||
             std::ranges::find(buses, each.first.bus, &BusSpec::name) == buses.end();
    });
    ended = end(book_.configure(buses), now);
    changed = take_changes();
  }
  publish(changed);
  return ended;
}

std::vector<AlarmRecord> AlarmTable::end(std::vector<KeptAlarm> ended, UtcTime now) {
  std::vector<AlarmRecord> records;
  for (auto& [alarm, status] : ended) {
    if (status.active) {
      records.push_back(record_of(alarm, AlarmState::kClear, status.value, now));
      if (sink_) sink_->put(records.back());
    }
    if (status.active || status.cleared_at.nanoseconds == 0) status.cleared_at = now;
    status.active = false;
    status.stage = AlarmStage::kClear;
    status.shelved = status.suppressed = {};
    ended_[alarm] = std::move(status);
  }
  return records;
}

void AlarmTable::note(const AlarmRecord& record) {
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    if (loading_ && held_.size() < kMaxHeld) held_.push_back(record);
    enter(record, read_clocks().utc);
    changed = take_changes();
  }
  publish(changed);
}

void AlarmTable::enter(const AlarmRecord& record, UtcTime now) {
  const auto limit = limit_kind_from(record.limit);
  if (!limit) return;
  const AlarmKey alarm{record.bus, record.device, record.channel, *limit};
  const bool began = record.state == to_text(AlarmState::kActive);
  // Already active or ended, or raised by its bus while the limit was removed.
  if (began ? !book_.raise(alarm, record.value, record.since, now)
            : !book_.clear(alarm, record.value, record.since))
    return;
  if (sink_) sink_->put(record);
}

AlarmOutcome AlarmTable::act(const AlarmAction& action, UtcTime now) {
  AlarmOutcome outcome;
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    if (loading_) {
      return tl::unexpected(
          AlarmRefusal{Cause::kOffline, "the store is not open, which knows how the alarms are"});
    }
    outcome = book_.act(action, now);
    changed = take_changes();
  }
  publish(changed);
  return outcome;
}

void AlarmTable::on_time(const std::string& bus, UtcTime now) {
  std::set<AlarmKey> changed;
  {
    const std::lock_guard lock(mutex_);
    book_.on_time(bus, now);
    changed = take_changes();
  }
  publish(changed);
}

AlarmCounts AlarmTable::counts() const {
  const std::lock_guard lock(mutex_);
  return book_.counts();
}

std::set<AlarmKey> AlarmTable::take_changes() {
  AlarmRegistry::News news = book_.take_news();
  if (sink_) {
    for (const AlarmKey& alarm : news.to_keep) {
      const AlarmStatus* status = book_.find(alarm);
      sink_->put(KeptAlarm{alarm, status == nullptr ? AlarmStatus{} : *status});
    }
    for (KeptMaintenance& maintenance : news.maintenance) sink_->put(std::move(maintenance));
    for (AlarmEvent& event : news.events) sink_->put(std::move(event));
  }
  return std::move(news.changed);
}

std::vector<AlarmRecord> AlarmTable::active_of(const std::string& bus) const {
  const std::lock_guard lock(mutex_);
  std::vector<AlarmRecord> found;
  for (const AlarmKey& alarm : book_.known_of(bus)) {
    const AlarmStatus& status = *book_.find(alarm);
    if (status.active)
      found.push_back(record_of(alarm, AlarmState::kActive, status.value, status.raised_at));
  }
  return found;
}

AlarmReporter::AlarmReporter(AlarmTable& table, const BusSpec& bus)
    : table_(table), monitor_(bus), bus_(bus.name) {
  ChannelIndex index = 0;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (monitor_.has_limits(index)) names_.try_emplace(index, device.name, channel.name);
      ++index;
    }
  }
}

std::vector<AlarmChange> AlarmReporter::on_samples(const std::vector<Sample>& samples,
                                                   const UtcMapping& mapping, Instant now) {
  std::vector<AlarmChange> all = restore();
  std::vector<AlarmChange> changes;
  monitor_.on_samples(samples, now, changes);
  note(changes, mapping, Origin::kNew);
  all.insert(all.end(), changes.begin(), changes.end());
  return all;
}

std::vector<AlarmChange> AlarmReporter::on_time(const UtcMapping& now) {
  table_.on_time(bus_, now.utc);
  std::vector<AlarmChange> all = restore();
  std::vector<AlarmChange> changes;
  monitor_.on_time(now.instant, changes);
  note(changes, now, Origin::kNew);
  all.insert(all.end(), changes.begin(), changes.end());
  return all;
}

std::vector<AlarmChange> AlarmReporter::restore() {
  std::vector<AlarmChange> changes;
  if (restored_ == table_.version()) return changes;
  restored_ = table_.version();
  const UtcMapping now = read_clocks();
  for (const AlarmRecord& record : table_.active_of(bus_)) {
    const auto limit = limit_kind_from(record.limit);
    const auto named = std::ranges::find(names_, std::pair{record.device, record.channel},
                                         &decltype(names_)::value_type::second);
    if (!limit || named == names_.end()) continue;
    monitor_.restore(
        {named->first, *limit, AlarmState::kActive, record.value, now.to_instant(record.since)},
        changes);
  }
  note(changes, now, Origin::kRestored);
  return changes;
}

void AlarmReporter::note(const std::vector<AlarmChange>& changes, const UtcMapping& mapping,
                         Origin origin) {
  for (const AlarmChange& change : changes) {
    const auto& [device, channel] = names_.at(change.channel);
    const AlarmRecord record{bus_,
                             device,
                             channel,
                             std::string(to_text(change.limit)),
                             std::string(to_text(change.state)),
                             change.value,
                             mapping.to_utc(change.since)};
    const bool active = change.state == AlarmState::kActive;
    log_line(active ? LogLevel::kWarning : LogLevel::kInfo,
             fmt::format("{}/{}/{}", bus_, device, channel),
             fmt::format("alarm {} {}{}: {}", record.limit,
                         active && origin == Origin::kRestored ? "still " : "", record.state,
                         number_text(change.value)));
    table_.note(record);
  }
}

}  // namespace fieldcast
