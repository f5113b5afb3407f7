#include "core/alarm/alarm_registry.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

UtcTime after(UtcTime now, Duration duration) { return {now.nanoseconds + duration.count()}; }

tl::unexpected<AlarmRefusal> refused(Cause cause, std::string reason) {
  return tl::unexpected(AlarmRefusal{cause, std::move(reason)});
}

AlarmKey first_of(const AlarmDevice& device) {
  return {device.first, device.second, {}, LimitKind::kLowLow};
}

AlarmDevice device_of(const AlarmKey& alarm) { return {alarm.bus, alarm.device}; }

}  // namespace

std::string_view to_text(AlarmEventKind kind) {
  switch (kind) {
    case AlarmEventKind::kAcknowledged: return "acknowledged";
    case AlarmEventKind::kShelved: return "shelved";
    case AlarmEventKind::kUnshelved: return "unshelved";
    case AlarmEventKind::kShelvingEnded: return "shelving ended";
    case AlarmEventKind::kMaintenance: return "maintenance";
    case AlarmEventKind::kMaintenanceEnded: return "maintenance ended";
    case AlarmEventKind::kChattering: return "chattering";
    case AlarmEventKind::kChatteringEnded: return "chattering ended";
  }
  return "?";
}

AlarmPriority priority_of(const Limits& limits, LimitKind kind) {
  if (limits.priority) return *limits.priority;
  return kind == LimitKind::kLowLow || kind == LimitKind::kHighHigh ? AlarmPriority::kHigh
                                                                    : AlarmPriority::kMedium;
}

std::vector<KeptAlarm> AlarmRegistry::configure(const std::vector<BusSpec>& buses) {
  limits_.clear();
  for (const BusSpec& bus : buses) {
    buses_.insert(bus.name);
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        const Limits& limits = channel.limits;
        const std::pair<LimitKind, bool> kinds[] = {
            {LimitKind::kLowLow, limits.low_low.has_value()},
            {LimitKind::kLow, limits.low.has_value()},
            {LimitKind::kHigh, limits.high.has_value()},
            {LimitKind::kHighHigh, limits.high_high.has_value()}};
        for (const auto& [kind, present] : kinds) {
          if (present)
            limits_.emplace(AlarmKey{bus.name, device.name, channel.name, kind},
                            priority_of(limits, kind));
        }
      }
    }
  }
  return forget_others();
}

// The store may be shared: alarms of other bridges' buses are not removed.
std::vector<KeptAlarm> AlarmRegistry::forget_others() {
  std::vector<KeptAlarm> ended;
  for (auto life = lives_.begin(); life != lives_.end();) {
    const auto limit = limits_.find(life->first);
    if (limit != limits_.end()) {
      if (life->second.status().priority != limit->second) news_.changed.insert(life->first);
      life->second.set_priority(limit->second);
      ++life;
      continue;
    }
    changed(life->first);
    if (!life->second.status().is_normal()) ended.push_back({life->first, life->second.status()});
    life = lives_.erase(life);
  }
  for (const auto& [device, pause] : maintenance_) suppress(device, pause);
  return ended;
}

std::vector<KeptAlarm> AlarmRegistry::restore(const KeptAlarms& kept, UtcTime now) {
  return restore_at(buses_, kept, now);
}

std::vector<KeptAlarm> AlarmRegistry::restore(const std::string& bus, const KeptAlarms& kept,
                                              UtcTime now) {
  return restore_at({bus}, kept, now);
}

std::vector<KeptAlarm> AlarmRegistry::restore_at(const Buses& buses, const KeptAlarms& kept,
                                                 UtcTime now) {
  std::erase_if(lives_, [&](const auto& each) {
    if (!buses.contains(each.first.bus)) return false;
    news_.changed.insert(each.first);
    return true;
  });
  std::erase_if(maintenance_, [&](const auto& each) { return buses.contains(each.first.first); });
  std::map<AlarmKey, std::vector<UtcTime>> occurrences;
  for (const auto& [alarm, at] : kept.occurrences) occurrences[alarm].push_back(at);
  std::map<AlarmKey, AlarmStatus> ended;
  std::set<AlarmKey> active;
  for (const KeptAlarm& each : kept.active) {
    if (!buses.contains(each.alarm.bus)) continue;
    if (!has_limit(each.alarm)) {
      AlarmStatus& status = ended[each.alarm];
      status.active = true;
      status.value = each.status.value;
      status.raised_at = each.status.raised_at;
      changed(each.alarm);
    } else {
      active.insert(each.alarm);
    }
  }
  for (const KeptAlarm& each : kept.states) {
    if (!buses.contains(each.alarm.bus)) continue;
    if (!has_limit(each.alarm)) {
      const bool is_active = ended.contains(each.alarm);
      if (is_active || !each.status.is_normal()) {
        ended[each.alarm] = each.status;
        ended[each.alarm].active = is_active;
      }
      changed(each.alarm);
      continue;
    }
    AlarmLife& life = life_of(each.alarm);
    life.restore(each.status, occurrences[each.alarm], now);
    news_.changed.insert(each.alarm);
    if (active.contains(each.alarm) || !life.status().active) continue;
    life.clear(life.status().value, now);  // the bridge stopped between the two changes
    changed(each.alarm);
  }
  for (const KeptAlarm& each : kept.active) {
    if (!active.contains(each.alarm) || life_of(each.alarm).status().active) continue;
    AlarmStatus status = life_of(each.alarm).status();
    status.stage = AlarmStage::kUnacknowledged;
    status.active = true;
    status.value = each.status.value;
    status.raised_at = each.status.raised_at;
    status.cleared_at = {};
    status.acknowledged = {};
    life_of(each.alarm).restore(status, occurrences[each.alarm], now);
    changed(each.alarm);
  }
  for (const KeptMaintenance& each : kept.maintenance) {
    if (buses.contains(each.device.first) && each.pause.is_set())
      suppress(each.device, maintenance_[each.device] = each.pause);
  }
  std::vector<KeptAlarm> all;
  for (auto& [alarm, status] : ended) all.push_back({alarm, std::move(status)});
  return all;
}

AlarmLife& AlarmRegistry::life_of(const AlarmKey& alarm) {
  const auto found = lives_.find(alarm);
  if (found != lives_.end()) return found->second;
  AlarmLife& life = lives_.emplace(alarm, AlarmLife(limits_.at(alarm))).first->second;
  const auto maintenance = maintenance_.find(device_of(alarm));
  if (maintenance != maintenance_.end()) life.suppress(maintenance->second);
  return life;
}

void AlarmRegistry::changed(const AlarmKey& alarm) {
  news_.changed.insert(alarm);
  news_.to_keep.insert(alarm);
}

void AlarmRegistry::tell(UtcTime at, const AlarmKey& alarm, AlarmEventKind kind,
                         const AlarmPause& pause) {
  news_.events.push_back({at, alarm, kind, pause.by, pause.note, pause.until});
}

void AlarmRegistry::tell_chatter(const AlarmKey& alarm, bool before, bool after, UtcTime now) {
  if (before != after)
    tell(now, alarm, after ? AlarmEventKind::kChattering : AlarmEventKind::kChatteringEnded);
}

bool AlarmRegistry::raise(const AlarmKey& alarm, double value, UtcTime since, UtcTime now) {
  if (!has_limit(alarm)) return false;
  AlarmLife& life = life_of(alarm);
  if (life.status().active) return false;
  const bool chattering = life.status().chattering;
  life.raise(value, since, now);
  changed(alarm);
  tell_chatter(alarm, chattering, life.status().chattering, now);
  return true;
}

bool AlarmRegistry::clear(const AlarmKey& alarm, double value, UtcTime since) {
  const auto found = lives_.find(alarm);
  if (found == lives_.end() || !found->second.status().active) return false;
  found->second.clear(value, since);
  changed(alarm);
  return true;
}

AlarmOutcome AlarmRegistry::act(const AlarmAction& action, UtcTime now) {
  if (action.by.empty()) return refused(Cause::kRange, "it must say who does it");
  return is_of_device(action.kind) ? act_on_device(action, now) : act_on_alarm(action, now);
}

AlarmOutcome AlarmRegistry::act_on_alarm(const AlarmAction& action, UtcTime now) {
  const AlarmKey& alarm = action.alarm;
  if (!has_limit(alarm))
    return refused(Cause::kUnknownChannel, "there is no such limit: " + to_text(alarm));
  AlarmLife clear(limits_.at(alarm));
  const bool shelves = action.kind == AlarmActionKind::kShelve;
  if (shelves && (action.duration <= Duration{} || action.duration > kLongestShelving))
    return refused(Cause::kRange, "an alarm is shelved for up to 24 hours");
  AlarmLife& life = shelves || lives_.contains(alarm) ? life_of(alarm) : clear;
  switch (action.kind) {
    case AlarmActionKind::kAcknowledge: {
      const auto done = life.acknowledge({action.by, action.note, now}, action.raised_at);
      if (!done) return done;
      tell(now, alarm, AlarmEventKind::kAcknowledged, {action.by, action.note, {}, {}});
      break;
    }
    case AlarmActionKind::kShelve: {
      const AlarmPause pause{action.by, action.note, now, after(now, action.duration)};
      life.shelve(pause);
      tell(now, alarm, AlarmEventKind::kShelved, pause);
      break;
    }
    case AlarmActionKind::kUnshelve: {
      if (const auto done = life.unshelve(); !done) return done;
      tell(now, alarm, AlarmEventKind::kUnshelved, {action.by, action.note, {}, {}});
      break;
    }
    case AlarmActionKind::kMaintenance:
    case AlarmActionKind::kEndMaintenance:
    case AlarmActionKind::kEndSession: break;  // handled in act_on_device(), or before
  }
  changed(alarm);
  return {};
}

AlarmOutcome AlarmRegistry::act_on_device(const AlarmAction& action, UtcTime now) {
  const AlarmDevice device = device_of(action.alarm);
  const AlarmKey whole = first_of(device);
  const auto first = limits_.lower_bound(whole);
  if (first == limits_.end() || device_of(first->first) != device)
    return refused(Cause::kUnknownDevice, "there is no device with alarms: " + to_text(whole));
  if (action.kind == AlarmActionKind::kEndMaintenance) {
    if (maintenance_.erase(device) == 0)
      return refused(Cause::kWrongState, "the device is not in maintenance");
    end_suppression(device);
    tell(now, whole, AlarmEventKind::kMaintenanceEnded, {action.by, action.note, {}, {}});
    return {};
  }
  if (action.duration <= Duration{} || action.duration > kLongestMaintenance)
    return refused(Cause::kRange, "maintenance takes up to 7 days");
  const AlarmPause pause{action.by, action.note, now, after(now, action.duration)};
  maintenance_[device] = pause;
  news_.maintenance.push_back({device, pause});
  suppress(device, pause);
  tell(now, whole, AlarmEventKind::kMaintenance, pause);
  return {};
}

template <class Do>
void AlarmRegistry::each_limit_of(const AlarmDevice& device, Do what) const {
  for (auto limit = limits_.lower_bound(first_of(device));
       limit != limits_.end() && device_of(limit->first) == device; ++limit)
    what(limit->first);
}

// Includes limits that were never exceeded: a station shows that they cannot raise an alarm.
void AlarmRegistry::suppress(const AlarmDevice& device, const AlarmPause& pause) {
  each_limit_of(device, [&](const AlarmKey& alarm) {
    life_of(alarm).suppress(pause);
    changed(alarm);
  });
}

void AlarmRegistry::end_suppression(const AlarmDevice& device) {
  news_.maintenance.push_back({device, {}});
  each_limit_of(device, [&](const AlarmKey& alarm) {
    life_of(alarm).end_suppression();
    changed(alarm);
  });
}

void AlarmRegistry::on_time(const std::string& bus, UtcTime now) {
  for (auto device = maintenance_.lower_bound({bus, {}});
       device != maintenance_.end() && device->first.first == bus;) {
    if (device->second.until > now) {
      ++device;
      continue;
    }
    const AlarmDevice ended = device->first;
    device = maintenance_.erase(device);
    end_suppression(ended);
    tell(now, first_of(ended), AlarmEventKind::kMaintenanceEnded);
  }
  for (auto each = lives_.lower_bound(first_of({bus, {}}));
       each != lives_.end() && each->first.bus == bus; ++each) {
    AlarmLife& life = each->second;
    const bool chattering = life.status().chattering;
    if (life.count(now)) news_.changed.insert(each->first);
    tell_chatter(each->first, chattering, life.status().chattering, now);
    if (!life.status().shelved.is_set() || life.status().shelved.until > now) continue;
    (void)life.unshelve();
    tell(now, each->first, AlarmEventKind::kShelvingEnded);
    changed(each->first);
  }
}

const AlarmStatus* AlarmRegistry::find(const AlarmKey& alarm) const {
  const auto found = lives_.find(alarm);
  return found == lives_.end() ? nullptr : &found->second.status();
}

AlarmCounts AlarmRegistry::counts() const {
  AlarmCounts counts;
  for (const auto& [alarm, life] : lives_) {
    if (life.status().chattering) ++counts.chattering;
    switch (life.state()) {
      case IsaState::kNormal: break;
      case IsaState::kUnacknowledged: ++counts.unacknowledged; break;
      case IsaState::kAcknowledged: ++counts.acknowledged; break;
      case IsaState::kReturned: ++counts.returned; break;
      case IsaState::kShelved: ++counts.shelved; break;
      case IsaState::kOutOfService: ++counts.suppressed; break;
    }
  }
  return counts;
}

std::vector<AlarmKey> AlarmRegistry::known_of(const std::string& bus) const {
  std::vector<AlarmKey> known;
  for (auto each = lives_.lower_bound(first_of({bus, {}}));
       each != lives_.end() && each->first.bus == bus; ++each)
    known.push_back(each->first);
  return known;
}

}  // namespace fieldcast
