// What people did about alarms: how each alarm is, which devices are in maintenance, and who did
// what. That limits were passed and kept again stands in EventTable. Everything throws StoreError.
#pragma once

#include <functional>

#include "bridge/store/records.hpp"
#include "bridge/store/sql.hpp"

namespace fieldcast {

class AlarmLifeTable {
 public:
  explicit AlarmLifeTable(SqlConnection& connection) : connection_(connection) {}

  // In place of what was known of it; one that is plainly clear is removed.
  void insert(const KeptAlarm& alarm);
  void insert(const KeptMaintenance& maintenance);  // one that has ended is removed
  void insert(const AlarmEvent& event);             // one that is there already is left alone

  // What the next bridge goes on with. Of any bridge: a store may be shared.
  [[nodiscard]] KeptAlarms kept(UtcTime now);

  // Everything that happened, in the order of time, of from <= time < to. False ends it.
  // The newest of them first, `limit` at most.
  void newest_log(UtcTime from, UtcTime to, std::int64_t limit,
                  const std::function<void(const AlarmLogEntry&)>& on_entry);
  void log(UtcTime from, UtcTime to, const std::function<bool(const AlarmLogEntry&)>& on_entry);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
