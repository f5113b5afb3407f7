// All alarms of a bridge and its devices in maintenance, driven by samples, operator actions and
// time. Pure; the owner guards it if several threads use it. An alarm is stored from its first
// occurrence, shelving or maintenance on; there are at most as many as limits. Changes are
// collected for DDS and the store.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/alarm/alarm_life.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

using AlarmDevice = std::pair<std::string, std::string>;

enum class AlarmEventKind : std::uint8_t {
  kAcknowledged,
  kShelved,
  kUnshelved,
  kShelvingEnded,  // by time
  kMaintenance,
  kMaintenanceEnded,  // by an operator, or by time
  kChattering,
  kChatteringEnded,
};
[[nodiscard]] std::string_view to_text(AlarmEventKind kind);  // "shelving ended"

// An event other than the start or end of a limit violation.
struct AlarmEvent {
  UtcTime at;
  AlarmKey alarm;  // without a channel: all alarms of the device
  AlarmEventKind kind = AlarmEventKind::kAcknowledged;
  std::string by, note;  // empty if it ended by time
  UtcTime until;         // if the event has an end
  friend bool operator==(const AlarmEvent&, const AlarmEvent&) = default;
};

struct KeptAlarm {
  AlarmKey alarm;
  // Priority, suppression and occurrences are not stored here.
  AlarmStatus status;
};
struct KeptMaintenance {
  AlarmDevice device;
  AlarmPause pause;  // not set if it has ended
};
struct KeptAlarms {
  // Exceeded limits; only value and raised_at of the status are used.
  std::vector<KeptAlarm> active;
  std::vector<KeptAlarm> states;
  std::vector<KeptMaintenance> maintenance;
  std::vector<std::pair<AlarmKey, UtcTime>> occurrences;  // of the last minutes, in order of time
};

// Shelved and suppressed alarms are only counted as such.
struct AlarmCounts {
  std::size_t unacknowledged = 0, acknowledged = 0, returned = 0, shelved = 0, suppressed = 0;
  std::size_t chattering = 0;  // of all
  friend bool operator==(const AlarmCounts&, const AlarmCounts&) = default;
};

class AlarmRegistry {
 public:
  static constexpr Duration kLongestShelving = std::chrono::hours{24};
  static constexpr Duration kLongestMaintenance = std::chrono::hours{7 * 24};

  // Sets the limits. Removes alarms of own buses without a limit and returns those that were not
  // normal.
  std::vector<KeptAlarm> configure(const std::vector<BusSpec>& buses);
  [[nodiscard]] bool has_limit(const AlarmKey& alarm) const { return limits_.contains(alarm); }

  // Replaces all alarms. Returns those that are not normal and whose limit was removed meanwhile.
  std::vector<KeptAlarm> restore(const KeptAlarms& kept, UtcTime now);
  // As above for one bus, which another bridge has served meanwhile.
  std::vector<KeptAlarm> restore(const std::string& bus, const KeptAlarms& kept, UtcTime now);

  // Returns false if the state did not change, or there is no such limit.
  bool raise(const AlarmKey& alarm, double value, UtcTime since, UtcTime now);
  bool clear(const AlarmKey& alarm, double value, UtcTime since);

  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);
  void on_time(const std::string& bus, UtcTime now);

  [[nodiscard]] const AlarmStatus* find(const AlarmKey& alarm) const;  // null if unknown
  [[nodiscard]] std::vector<AlarmKey> known_of(const std::string& bus) const;
  [[nodiscard]] AlarmCounts counts() const;

  struct News {
    std::set<AlarmKey> changed;  // changed or removed; see find()
    std::set<AlarmKey> to_keep;  // the subset whose KeptAlarm changed
    std::vector<KeptMaintenance> maintenance;
    std::vector<AlarmEvent> events;
  };
  [[nodiscard]] News take_news() { return std::exchange(news_, {}); }

 private:
  using Lives = std::map<AlarmKey, AlarmLife>;
  using Buses = std::set<std::string>;
  [[nodiscard]] std::vector<KeptAlarm> forget_others();
  [[nodiscard]] std::vector<KeptAlarm> restore_at(const Buses& buses, const KeptAlarms& kept,
                                                  UtcTime now);
  AlarmLife& life_of(const AlarmKey& alarm);
  void changed(const AlarmKey& alarm);
  void tell(UtcTime at, const AlarmKey& alarm, AlarmEventKind kind, const AlarmPause& pause = {});
  void tell_chatter(const AlarmKey& alarm, bool before, bool after, UtcTime now);
  template <class Do>
  void each_limit_of(const AlarmDevice& device, Do what) const;
  void suppress(const AlarmDevice& device, const AlarmPause& pause);
  void end_suppression(const AlarmDevice& device);
  AlarmOutcome act_on_device(const AlarmAction& action, UtcTime now);
  AlarmOutcome act_on_alarm(const AlarmAction& action, UtcTime now);

  std::map<AlarmKey, AlarmPriority> limits_;  // in force
  std::set<std::string> buses_;               // of this bridge, now or before
  Lives lives_;
  std::map<AlarmDevice, AlarmPause> maintenance_;
  News news_;
};

[[nodiscard]] AlarmPriority priority_of(const Limits& limits, LimitKind kind);

}  // namespace fieldcast
