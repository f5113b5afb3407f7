#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "core/alarm/alarm_registry.hpp"
#include "core/base/duration_text.hpp"

namespace fieldcast::alarm_transcript {

inline constexpr std::int64_t kBegin = 1'000'000'000'000'000;
constexpr UtcTime after(Duration since_begin) { return {kBegin + since_begin.count()}; }

inline std::vector<BusSpec> two_buses() {
  std::vector<BusSpec> buses(2);
  for (std::size_t bus = 0; bus < 2; ++bus) {
    buses[bus].name = bus == 0 ? "shop" : "yard";
    for (const char* device : {"press-1", "press-2"}) {
      DeviceSpec& made = buses[bus].devices.emplace_back();
      made.name = device;
      ChannelSpec& level = made.channels.emplace_back();
      level.name = "level";
      level.limits = {.low_low = 5, .low = 10, .high = 90, .high_high = 95};
      ChannelSpec& plain = made.channels.emplace_back();
      plain.name = "plain";
      ChannelSpec& valve = made.channels.emplace_back();
      valve.name = "valve";
      valve.limits.high = 1;
      valve.limits.priority = AlarmPriority::kCritical;
    }
  }
  return buses;
}

inline std::string time_text(UtcTime time) {
  return time.nanoseconds == 0 ? "-" : to_text(Duration{time.nanoseconds - kBegin});
}

inline std::string status_text(const AlarmStatus& status) {
  std::ostringstream text;
  text << to_text(status.stage) << (status.active ? ", active" : "") << ", "
       << to_text(status.priority);
  if (status.occurrences > 0) text << ", " << status.occurrences << " times";
  if (status.chattering) text << ", chattering";
  if (status.acknowledged.at.nanoseconds != 0)
    text << ", acked by " << status.acknowledged.by << " at " << time_text(status.acknowledged.at);
  if (status.shelved.is_set())
    text << ", shelved by " << status.shelved.by << " until " << time_text(status.shelved.until);
  if (status.suppressed.is_set())
    text << ", suppressed until " << time_text(status.suppressed.until);
  return text.str();
}

inline AlarmKey key_of(const std::string& path, const std::string& limit) {
  AlarmKey key;
  std::istringstream parts(path);
  std::getline(parts, key.bus, '/');
  std::getline(parts, key.device, '/');
  std::getline(parts, key.channel, '/');
  if (const auto kind = limit_kind_from(limit)) key.limit = *kind;
  return key;
}

class Transcript {
 public:
  std::string replay(const std::string& text) {
    (void)book_.configure(two_buses());
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("  ")) continue;  // expected output
      out_ << line << '\n';
      if (line.empty() || line.starts_with('#')) continue;
      happen(line);
      see();
    }
    return out_.str();
  }

 private:
  // Examples: "5s anna acknowledges shop/press-1/level high"; "9s raise shop/press-1/level high 95"
  void happen(const std::string& line) {
    std::istringstream words(line);
    std::string when, who, what, path, limit;
    words >> when >> who;
    const UtcTime now = after(*duration_from(when));
    if (who == "time") {
      book_.on_time("shop", now);
      return;
    }
    if (who == "raise" || who == "clear") {
      double value = 0;
      words >> path >> limit >> value;
      const AlarmKey alarm = key_of(path, limit);
      const bool done =
          who == "raise" ? book_.raise(alarm, value, now, now) : book_.clear(alarm, value, now);
      if (!done) out_ << "  nothing\n";
      return;
    }
    AlarmAction action;
    action.by = who == "nobody" ? "" : who;
    words >> what >> path;
    action.kind = what == "acknowledges" ? AlarmActionKind::kAcknowledge
                  : what == "shelves"    ? AlarmActionKind::kShelve
                  : what == "unshelves"  ? AlarmActionKind::kUnshelve
                  : what == "maintains"  ? AlarmActionKind::kMaintenance
                                         : AlarmActionKind::kEndMaintenance;
    if (!is_of_device(action.kind)) words >> limit;
    action.alarm = key_of(path, limit);
    std::string length;
    if (words >> length >> length) action.duration = *duration_from(length);
    if (const auto done = book_.act(action, now); !done)
      out_ << "  refused: " << done.error().reason << " (" << to_name(done.error().cause) << ")\n";
  }
  void see() {
    const AlarmRegistry::News news = book_.take_news();
    for (const AlarmEvent& event : news.events) {
      out_ << "  event: " << to_text(event.alarm) << ' ' << to_text(event.kind);
      if (!event.by.empty()) out_ << " by " << event.by;
      if (event.until.nanoseconds != 0) out_ << " until " << time_text(event.until);
      out_ << '\n';
    }
    for (const AlarmKey& alarm : news.changed) {
      const AlarmStatus* status = book_.find(alarm);
      out_ << "  " << to_text(alarm) << ": "
           << (status == nullptr ? "forgotten" : status_text(*status)) << '\n';
    }
  }
  AlarmRegistry book_;
  std::ostringstream out_;
};

}  // namespace fieldcast::alarm_transcript
