#include "bridge/publish/alarm_table.hpp"

#include <utility>

#include "bridge/bus/clock.hpp"
#include "core/alarm/limit_watch.hpp"

namespace fieldcast {
namespace {

std::string text_of(LimitKind kind) { return std::string(to_text(kind)); }

}  // namespace

AlarmTable::Key AlarmTable::key_of(const AlarmRecord& record) {
  return {record.bus, record.device, record.channel, record.limit};
}

void AlarmTable::expect_store() {
  const std::lock_guard lock(mutex_);
  loading_ = true;
  active_.clear();  // the store knows
}

void AlarmTable::loaded(AlarmSink& sink, const std::vector<AlarmRecord>& active) {
  const std::lock_guard lock(mutex_);
  sink_ = &sink;
  loading_ = false;
  for (const AlarmRecord& record : active) active_[key_of(record)] = record;
  for (const AlarmRecord& record : std::exchange(held_, {})) keep(record);
  end_others(read_clocks().utc);
  version_.fetch_add(1, std::memory_order_release);
}

void AlarmTable::close(AlarmSink* sink) {
  const std::lock_guard lock(mutex_);
  for (AlarmRecord& record : std::exchange(held_, {})) {
    if (sink) sink->put(std::move(record));
  }
  sink_ = nullptr;
  loading_ = false;
}

std::vector<AlarmRecord> AlarmTable::configure(const std::vector<BusSpec>& buses, UtcTime now) {
  const std::lock_guard lock(mutex_);
  limits_.clear();
  for (const BusSpec& bus : buses) {
    buses_.insert(bus.name);
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        const std::pair<LimitKind, bool> kinds[] = {
            {LimitKind::kLowLow, channel.limits.low_low.has_value()},
            {LimitKind::kLow, channel.limits.low.has_value()},
            {LimitKind::kHigh, channel.limits.high.has_value()},
            {LimitKind::kHighHigh, channel.limits.high_high.has_value()}};
        for (const auto& [kind, present] : kinds) {
          if (present) limits_.emplace(bus.name, device.name, channel.name, text_of(kind));
        }
      }
    }
  }
  return end_others(now);
}

// A store may be shared: what other bridges' buses have there is not ours to end.
std::vector<AlarmRecord> AlarmTable::end_others(UtcTime now) {
  std::vector<AlarmRecord> ended;
  std::erase_if(active_, [&](const auto& entry) {
    const auto& [key, record] = entry;
    if (limits_.contains(key) || !buses_.contains(record.bus)) return false;
    AlarmRecord& end = ended.emplace_back(record);
    end.state = std::string(to_text(AlarmState::kClear));
    end.since = now;
    return true;
  });
  for (const AlarmRecord& record : ended) {
    if (sink_) sink_->put(record);
  }
  return ended;
}

void AlarmTable::note(const AlarmRecord& record) {
  const std::lock_guard lock(mutex_);
  if (loading_ && held_.size() < kMaxHeld) return held_.push_back(record);
  keep(record);
}

void AlarmTable::keep(const AlarmRecord& record) {
  const Key key = key_of(record);
  if (record.state == to_text(AlarmState::kActive)) {
    // It goes on, or the bus raised it while the limit was taken away.
    if (active_.contains(key) || !limits_.contains(key)) return;
    active_[key] = record;
  } else if (active_.erase(key) == 0) {
    return;  // it has ended already
  }
  if (sink_) sink_->put(record);
}

std::vector<AlarmRecord> AlarmTable::active_of(const std::string& bus) const {
  const std::lock_guard lock(mutex_);
  std::vector<AlarmRecord> found;
  for (const auto& [key, record] : active_) {
    if (record.bus == bus) found.push_back(record);
  }
  return found;
}

}  // namespace fieldcast
