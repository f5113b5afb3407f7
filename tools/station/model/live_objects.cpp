#include "tools/station/model/live_objects.hpp"

#include <algorithm>
#include <utility>

#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {
namespace {

// The first byte is the kind; the names are separated by a byte that no name contains.
std::string joined(char kind, const std::string& a, const std::string& b = {}) {
  return std::string(1, kind) + a + '\x1F' + b;
}

struct KeyOf {
  std::string operator()(const StationBusStatus& bus) const { return joined('b', bus.bus); }
  std::string operator()(const StationDeviceStatus& device) const {
    return joined('d', device.bus, device.device);
  }
  std::string operator()(const LiveAlarm& alarm) const {
    return joined('a', alarm.bus, alarm.device + '\x1F' + alarm.channel + '\x1F') +
           std::string(to_text(alarm.limit));
  }
  std::string operator()(const LiveSession& live) const {
    return joined('s', live.session.bus, live.session.device);
  }
  std::string operator()(const StationBridge& bridge) const { return joined('r', bridge.bridge); }
  std::string operator()(const StationReadPlan& plan) const { return joined('p', plan.bus); }
  std::string operator()(const StationDeviceDescription& about) const {
    return joined('e', about.bus, about.device);
  }
  std::string operator()(const Interest& interest) const {
    return joined('i', interest.station, interest.pattern);
  }
  std::string operator()(const LiveSite& site) const { return joined('t', site.site); }
  std::string operator()(const LiveStream&) const { return joined('m', {}); }
};

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
  std::string operator()(const LiveSession& session) const {
    return kind_message("session", session_json(session));
  }
  std::string operator()(const StationBridge& bridge) const {
    return gone ? kind_message("bridge_gone", names_json({{"bridge", bridge.bridge}}))
                : kind_message("bridge", bridge_json(bridge));
  }
  std::string operator()(const StationReadPlan& plan) const {
    return kind_message("plan", names_json({{"bus", plan.bus}}));
  }
  std::string operator()(const StationDeviceDescription& about) const {
    return gone ? kind_message("description_gone",
                               names_json({{"bus", about.bus}, {"device", about.device}}))
                : kind_message("description", description_json(about));
  }
  std::string operator()(const Interest& interest) const {
    return kind_message(gone ? "interest_gone" : "interest", interest_json(interest));
  }
  std::string operator()(const LiveSite& site) const {
    return kind_message("site", site_json(site));
  }
  std::string operator()(const LiveStream& stream) const {
    return kind_message("stream", stream_json(stream));
  }
};

bool is_clear(const LiveAlarm& alarm) {
  return alarm.state == "clear" && !alarm.active && alarm.suppressed.empty() &&
         alarm.shelved_until.nanoseconds == 0;
}

// Returns whether `last` must stay: it is detailed, and the report of the same alarm is not.
bool outranks(const LiveObject* last, const LiveObject& report) {
  const auto* const alarm = std::get_if<LiveAlarm>(&report);
  return last != nullptr && alarm != nullptr && !alarm->detailed &&
         std::get<LiveAlarm>(*last).detailed;
}

// `report` is one of the two reports of a session, and becomes both.
void join(const LiveObject* last, LiveSession& report) {
  if (last != nullptr) {
    const auto& known = std::get<LiveSession>(*last);
    const bool is_request = report.requested_at.nanoseconds != 0;
    report = is_request ? LiveSession{known.session, report.request, report.requested_at}
                        : LiveSession{report.session, known.request, known.requested_at};
  }
  if (report.requested_at.nanoseconds >= report.session.since.nanoseconds) return;
  report.request.clear();
  report.requested_at = {};
}

}  // namespace

LiveSession live_session(const ProgramRequestReport& report) {
  LiveSession live;
  live.session.bus = report.bus;
  live.session.device = report.device;
  live.request = report.request;
  live.requested_at = report.sent_at;
  return live;
}

std::string key_of(const LiveObject& object) { return std::visit(KeyOf{}, object); }

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
  live.raised_at = status.raised_at;
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

const LiveObject* LiveObjects::present(const std::string& key) const {
  const auto found = entries_.find(key);
  return found == entries_.end() || found->second.gone ? nullptr : &found->second.object;
}

LiveObjects::Entry* LiveObjects::entry_of(const std::string& key, std::size_t kind) {
  if (const auto found = entries_.find(key); found != entries_.end()) return &found->second;
  if (counts_[kind] >= kMaxObjects) {
    ++refused_;
    return nullptr;
  }
  ++counts_[kind];
  Entry& entry = entries_[key];
  entry.changed = changed_.insert(changed_.end(), &entry);
  return &entry;
}

void LiveObjects::put(LiveObject object) {
  const std::string key = key_of(object);
  const LiveObject* const last = present(key);
  if (outranks(last, object)) return;
  if (auto* const session = std::get_if<LiveSession>(&object)) join(last, *session);
  const auto* const alarm = std::get_if<LiveAlarm>(&object);
  const bool clear = alarm != nullptr && is_clear(*alarm);
  if (clear && !entries_.contains(key)) return;
  if (const auto* const plan = std::get_if<StationReadPlan>(&object);
      plan != nullptr && last != nullptr && std::get<StationReadPlan>(*last).plan == plan->plan)
    return;
  Entry* const entry = entry_of(key, object.index());
  if (entry == nullptr) return;
  bool quietly = false;
  if (const auto* const device = std::get_if<StationDeviceStatus>(&object)) {
    const std::int64_t passed = device->reported_at.nanoseconds - entry->told_at.nanoseconds;
    // If the clock was set back, the device is reported.
    quietly = last != nullptr && passed >= 0 && passed < kDevicePeriod.count() &&
              looks_the_same(std::get<StationDeviceStatus>(*last).report, device->report);
    if (!quietly) entry->told_at = device->reported_at;
  }
  entry->object = std::move(object);
  if (std::exchange(entry->gone, false)) gone_.remove(key);
  if (!quietly) touch(*entry);
  if (clear) remove_entry(key);
}

void LiveObjects::remove(const LiveObject& object) {
  const std::string key = key_of(object);
  const auto found = entries_.find(key);
  if (found == entries_.end() || found->second.gone) return;
  LiveObject& last = found->second.object;
  if (outranks(&last, object)) return;
  if (auto* const alarm = std::get_if<LiveAlarm>(&last)) {  // the last message reports it as clear
    alarm->state = "clear";
    alarm->active = false;
  }
  remove_entry(key);
}

const StationReadPlan* LiveObjects::read_plan(const std::string& bus) const {
  const LiveObject* const found = present(joined('p', bus));
  return found == nullptr ? nullptr : &std::get<StationReadPlan>(*found);
}

const StationDeviceDescription* LiveObjects::description(const std::string& bus,
                                                         const std::string& device) const {
  const LiveObject* const found = present(joined('e', bus, device));
  return found == nullptr ? nullptr : &std::get<StationDeviceDescription>(*found);
}

bool LiveObjects::is_of_stream(const std::string& bus) const {
  const std::size_t end = bus.find(':');
  return end != bus.npos && present(joined('t', bus.substr(0, end))) != nullptr;
}

void LiveObjects::remove_entry(const std::string& key) {
  Entry& entry = entries_.at(key);
  entry.gone = true;
  touch(entry);
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
