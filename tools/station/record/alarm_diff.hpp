// Derives alarm events for the store from successive statuses, because DDS publishes only these.
// Events use the times in the status, so a second recorder writes equal records. Pure; cannot fail.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records/records.hpp"
#include "core/alarm/alarm_registry.hpp"

namespace fieldcast::web {

struct AlarmNews {
  std::vector<AlarmRecord> records;  // raised, cleared
  std::vector<AlarmEvent> events;
  std::vector<KeptAlarm> kept;
  std::vector<KeptMaintenance> maintenance;
};

class AlarmDiff {
 public:
  static constexpr std::size_t kMaxAlarms = 50'000;  // further alarms are ignored

  // `received`: local time, for events without a time of their own.
  [[nodiscard]] AlarmNews next(const StationAlarmStatus& alarm, UtcTime received);

 private:
  void compare(const AlarmKey& key, const AlarmStatus& before, const AlarmStatus& now,
               UtcTime received, AlarmNews& news);
  void compare_shelving(const AlarmKey& key, const AlarmPause& before, const AlarmPause& now,
                        UtcTime received, AlarmNews& news);
  // All alarms of a device report its maintenance; it is recorded once.
  void compare_maintenance(const AlarmKey& key, const AlarmPause& now, UtcTime received,
                           AlarmNews& news);

  std::map<AlarmKey, AlarmStatus> known_;
  std::map<AlarmDevice, AlarmPause> maintenance_;
};

}  // namespace fieldcast::web
