#include "tools/station/record/alarm_diff.hpp"

namespace fieldcast::web {
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

}  // namespace fieldcast::web
