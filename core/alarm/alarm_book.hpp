// All alarms of a bridge, and the devices that are in maintenance: what the samples say, what
// people do, what ends with time. Pure: `now` is passed in; one owner, who guards it if several
// threads use it.
//
// An alarm is known here from its first occurrence on, or since somebody shelved it or put its
// device into maintenance; at most as many as there are limits. What changed is collected as news,
// for DDS and for the store.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/alarm/alarm_life.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// A bus and one of its devices.
using AlarmDevice = std::pair<std::string, std::string>;

enum class AlarmEventKind : std::uint8_t {
  kAcknowledged,
  kShelved,
  kUnshelved,
  kShelvingEnded,  // by time
  kMaintenance,
  kMaintenanceEnded,  // by a person, or by time
  kChattering,
  kChatteringEnded,
};
[[nodiscard]] std::string_view to_text(AlarmEventKind kind);  // "shelving ended"

// What happened besides that a limit was passed or kept again.
struct AlarmEvent {
  UtcTime at;
  AlarmKey alarm;  // without a channel: all alarms of the device
  AlarmEventKind kind = AlarmEventKind::kAcknowledged;
  std::string by, note;  // empty: time did it
  UtcTime until;         // of what has an end
  friend bool operator==(const AlarmEvent&, const AlarmEvent&) = default;
};

// What outlives a bridge.
struct KeptAlarm {
  AlarmKey alarm;
  // All but priority and suppression, which are not the alarm's own, and the occurrences.
  AlarmStatus status;
};
struct KeptMaintenance {
  AlarmDevice device;
  AlarmPause pause;  // not set: it has ended
};
struct KeptAlarms {
  std::vector<KeptAlarm> active;  // the limits that are passed; of the status value and raised_at
  std::vector<KeptAlarm> states;
  std::vector<KeptMaintenance> maintenance;
  std::vector<std::pair<AlarmKey, UtcTime>> occurrences;  // of the last minutes, in order of time
};

// How many alarms there are of each kind; one that is shelved or suppressed counts as that alone.
struct AlarmCounts {
  std::size_t unacknowledged = 0, acknowledged = 0, returned = 0, shelved = 0, suppressed = 0;
  std::size_t chattering = 0;  // of all of them
  friend bool operator==(const AlarmCounts&, const AlarmCounts&) = default;
};

class AlarmBook {
 public:
  static constexpr Duration kLongestShelving = std::chrono::hours{24};
  static constexpr Duration kLongestMaintenance = std::chrono::hours{7 * 24};

  // The limits that are in force from now on. An alarm at another one of these buses, or of the
  // buses before, is forgotten; those that were active come back.
  std::vector<KeptAlarm> configure(const std::vector<BusSpec>& buses);
  [[nodiscard]] bool has_limit(const AlarmKey& alarm) const { return limits_.contains(alarm); }

  // Everything that was known before is replaced. What ended at buses of ours while they had no
  // such limit comes back.
  std::vector<KeptAlarm> restore(const KeptAlarms& kept, UtcTime now);
  // The same for one bus alone: another bridge has served it meanwhile.
  std::vector<KeptAlarm> restore(const std::string& bus, const KeptAlarms& kept, UtcTime now);

  // True: it began, or ended. False: it did so before, or there is no such limit.
  bool raise(const AlarmKey& alarm, double value, UtcTime since, UtcTime now);
  bool clear(const AlarmKey& alarm, double value, UtcTime since);

  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);
  // What ends by itself at the alarms of this bus.
  void on_time(const std::string& bus, UtcTime now);

  [[nodiscard]] const AlarmStatus* find(const AlarmKey& alarm) const;  // null: not known
  [[nodiscard]] std::vector<AlarmKey> known_of(const std::string& bus) const;
  [[nodiscard]] AlarmCounts counts() const;

  struct News {
    std::set<AlarmKey> changed;  // or forgotten: find() says which
    std::set<AlarmKey> to_keep;  // those of them whose KeptAlarm changed
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

// Of a limit of the channel.
[[nodiscard]] AlarmPriority priority_of(const Limits& limits, LimitKind kind);

}  // namespace fieldcast
