// What happened to an alarm between two of its statuses, as the store keeps it. DDS tells how an
// alarm is, not what happened; what carries its own time is the same whoever records it again.
//
// Pure: no clock, no thread; one owner. Nothing can fail.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/store/records.hpp"
#include "core/alarm/alarm_book.hpp"

namespace fieldcast::web {

struct AlarmNews {
  std::vector<AlarmRecord> records;  // raised, cleared
  std::vector<AlarmEvent> events;
  std::vector<KeptAlarm> kept;
  std::vector<KeptMaintenance> maintenance;
};

class AlarmDiff {
 public:
  static constexpr std::size_t kMaxAlarms = 50'000;  // others are left out

  // `received`: by this machine's clock, for what has no time of its own.
  [[nodiscard]] AlarmNews next(const StationAlarmStatus& alarm, UtcTime received);

 private:
  void compare(const AlarmKey& key, const AlarmStatus& before, const AlarmStatus& now,
               UtcTime received, AlarmNews& news);
  void compare_shelving(const AlarmKey& key, const AlarmPause& before, const AlarmPause& now,
                        UtcTime received, AlarmNews& news);
  // All alarms of a device tell of its maintenance; it is one.
  void compare_maintenance(const AlarmKey& key, const AlarmPause& now, UtcTime received,
                           AlarmNews& news);

  std::map<AlarmKey, AlarmStatus> known_;
  std::map<AlarmDevice, AlarmPause> maintenance_;
};

}  // namespace fieldcast::web
