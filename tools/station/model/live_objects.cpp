#include "tools/station/model/live_objects.hpp"

#include <algorithm>
#include <utility>

#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {
namespace {

// The first byte is the kind; the names are separated by a byte that no name contains.
std::string key_of(char kind, const std::string& a, const std::string& b = {}) {
  return std::string(1, kind) + a + '\x1F' + b;
}
std::string key_of(const LiveAlarm& alarm) {
  return key_of('a', alarm.bus, alarm.device + '\x1F' + alarm.channel + '\x1F') +
         std::string(to_text(alarm.limit));
}

// Returns whether the reports differ only in details that the page does not show.
bool looks_the_same(const DeviceReport& a, const DeviceReport& b) {
  return a.state == b.state && a.refused == b.refused && a.refused_gaps == b.refused_gaps;
}

struct MessageOf {
  bool gone;
  std::string operator()(const StationBusStatus& bus) const {
    return gone ? kind_message("bus_gone", names_json({{"bus", bus.bus}}))
                : kind_message("bus", bus_json(bus));
  }
  std::string operator()(const StationDeviceStatus& device) const {
    return gone ? kind_message("device_gone",
                               names_json({{"bus", device.bus}, {"device", device.device}}))
                : kind_message("device", device_json(device));
  }
  std::string operator()(const LiveAlarm& alarm) const {
    return kind_message("alarm", alarm_json(alarm));
  }
  std::string operator()(const ProgramSessionReport& session) const {
    return kind_message("session", session_json(session));
  }
  std::string operator()(const StationBridge& bridge) const {
    return gone ? kind_message("bridge_gone", names_json({{"bridge", bridge.bridge}}))
                : kind_message("bridge", bridge_json(bridge));
  }
  std::string operator()(const StationReadPlan& plan) const {
    return kind_message("plan", names_json({{"bus", plan.bus}}));
  }
};

}  // namespace

LiveAlarm live_alarm(const StationAlarm& alarm) {
  LiveAlarm live;
  live.bus = alarm.bus;
  live.device = alarm.device;
  live.channel = alarm.channel;
  live.limit = alarm.limit;
  const bool outer = alarm.limit == LimitKind::kHighHigh || alarm.limit == LimitKind::kLowLow;
  live.priority = outer ? "high" : "medium";
  live.active = alarm.state == AlarmState::kActive;
  live.state = live.active ? "unacknowledged" : "clear";
  live.value = alarm.value;
  live.since = alarm.since;
  return live;
}

LiveAlarm live_alarm(const StationAlarmStatus& told) {
  const AlarmStatus& status = told.status;
  LiveAlarm live;
  live.bus = told.alarm.bus;
  live.device = told.alarm.device;
  live.channel = told.alarm.channel;
  live.limit = told.alarm.limit;
  live.priority = to_text(status.priority);
  live.state = to_text(status.stage);
  live.active = status.active;
  live.value = status.value;
  live.since = status.since();
  live.occurrences = status.occurrences;
  live.chattering = status.chattering;
  live.acknowledged_by = status.acknowledged.by;
  live.acknowledged_at = status.acknowledged.at;
  live.note = status.acknowledged.note;
  live.shelved_until = status.shelved.until;
  live.shelved_by = status.shelved.by;
  if (status.suppressed.is_set()) live.suppressed = "maintenance";
  live.detailed = true;
  return live;
}

void LiveObjects::touch(Entry& entry) {
  entry.version = ++version_;
  entry.message.reset();
  changed_.splice(changed_.end(), changed_, entry.changed);
}

void LiveObjects::put(const std::string& key, Object object, bool quietly) {
  const std::size_t kind = object.index();
  auto found = entries_.find(key);
  if (found == entries_.end()) {
    if (counts_[kind] >= kMaxObjects) {
      ++refused_;
      return;
    }
    ++counts_[kind];
    found = entries_.try_emplace(key).first;
    found->second.changed = changed_.insert(changed_.end(), &found->second);
  }
  Entry& entry = found->second;
  entry.object = std::move(object);
  if (std::exchange(entry.gone, false)) gone_.remove(key);
  if (!quietly) touch(entry);
}

void LiveObjects::put(const StationBusStatus& bus) { put(key_of('b', bus.bus), bus); }

void LiveObjects::put(const StationDeviceStatus& device) {
  const std::string key = key_of('d', device.bus, device.device);
  const auto found = entries_.find(key);
  bool quietly = false;
  if (found != entries_.end() && !found->second.gone) {
    const auto& last = std::get<StationDeviceStatus>(found->second.object);
    const std::int64_t passed = device.reported_at.nanoseconds - found->second.told_at.nanoseconds;
    // If the clock was set back, the device is reported.
    quietly =
        looks_the_same(last.report, device.report) && passed >= 0 && passed < kDevicePeriod.count();
  }
  put(key, device, quietly);
  if (quietly) return;
  if (const auto put_now = entries_.find(key); put_now != entries_.end())
    put_now->second.told_at = device.reported_at;
}

void LiveObjects::put(const LiveAlarm& alarm) {
  const std::string key = key_of(alarm);
  if (const auto found = entries_.find(key); found != entries_.end() && !found->second.gone &&
                                             !alarm.detailed &&
                                             std::get<LiveAlarm>(found->second.object).detailed)
    return;
  const bool clear = alarm.state == "clear" && !alarm.active && alarm.suppressed.empty() &&
                     alarm.shelved_until.nanoseconds == 0;
  if (clear && !entries_.contains(key)) return;
  put(key, alarm);
  if (clear) remove(key);
}

void LiveObjects::put(const ProgramSessionReport& session) {
  put(key_of('s', session.bus, session.device), session);
}

void LiveObjects::put(const StationBridge& bridge) { put(key_of('r', bridge.bridge), bridge); }

void LiveObjects::put(const StationReadPlan& plan) {
  const StationReadPlan* last = read_plan(plan.bus);
  if (last == nullptr || last->plan != plan.plan) put(key_of('p', plan.bus), plan);
}

void LiveObjects::remove(const LiveAlarm& alarm) {
  const std::string key = key_of(alarm);
  const auto found = entries_.find(key);
  if (found == entries_.end() || found->second.gone) return;
  if (!alarm.detailed && std::get<LiveAlarm>(found->second.object).detailed) return;
  // The last message reports the alarm as clear.
  auto& last = std::get<LiveAlarm>(found->second.object);
  last.state = "clear";
  last.active = false;
  remove(key);
}

void LiveObjects::remove_bus(const std::string& bus) { remove(key_of('b', bus)); }
void LiveObjects::remove_device(const std::string& bus, const std::string& device) {
  remove(key_of('d', bus, device));
}
void LiveObjects::remove_bridge(const std::string& bridge) { remove(key_of('r', bridge)); }
void LiveObjects::remove_read_plan(const std::string& bus) { remove(key_of('p', bus)); }

const StationReadPlan* LiveObjects::read_plan(const std::string& bus) const {
  const auto found = entries_.find(key_of('p', bus));
  if (found == entries_.end() || found->second.gone) return nullptr;
  return &std::get<StationReadPlan>(found->second.object);
}

void LiveObjects::remove(const std::string& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end() || std::exchange(found->second.gone, true)) return;
  touch(found->second);
  gone_.push_back(key);
  if (gone_.size() > kMaxGone) forget_oldest();
}

void LiveObjects::forget_oldest() {
  const auto oldest = entries_.find(gone_.front());
  gone_.pop_front();
  forgotten_ = std::max(forgotten_, oldest->second.version);
  --counts_[oldest->second.object.index()];
  changed_.erase(oldest->second.changed);
  entries_.erase(oldest);
}

LiveObjects::News LiveObjects::since(std::uint64_t version, std::size_t limit) const {
  News news{.version = version_};
  if (version != 0 && version < forgotten_) news.lost = true;
  auto first = changed_.end();
  while (first != changed_.begin() && (*std::prev(first))->version > version) --first;
  for (; first != changed_.end(); ++first) {
    const Entry& entry = **first;
    if (entry.gone && version == 0) continue;
    if (news.messages.size() == limit) {
      news.version = (*std::prev(first))->version;
      break;
    }
    if (!entry.message)
      entry.message =
          std::make_shared<const std::string>(std::visit(MessageOf{entry.gone}, entry.object));
    news.messages.push_back(entry.message);
  }
  return news;
}

}  // namespace fieldcast::web
