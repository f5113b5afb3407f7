// Actions on alarms: the state of each alarm, the devices in maintenance, and the log of actions.
// EventTable stores when limits were exceeded and met again. Everything throws StoreError.
#pragma once

#include <functional>

#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {

class AlarmLifeTable {
 public:
  explicit AlarmLifeTable(SqlConnection& connection) : connection_(connection) {}

  // Replaces the previous state. An alarm that is clear in every respect is removed.
  void insert(const KeptAlarm& alarm);
  void insert(const KeptMaintenance& maintenance);  // one that has ended is removed
  void insert(const AlarmEvent& event);             // an existing one is not changed

  // State with which the next bridge continues, of all bridges: a store may be shared.
  [[nodiscard]] KeptAlarms kept(UtcTime now);

  // Reads the events with from <= time < to. newest_log() calls `on_entry` for the newest first, at
  // most `limit`; log() reads in the order of time until `on_entry` returns false.
  void newest_log(UtcTime from, UtcTime to, std::int64_t limit,
                  const std::function<void(const AlarmLogEntry&)>& on_entry);
  void log(UtcTime from, UtcTime to, const std::function<bool(const AlarmLogEntry&)>& on_entry);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
