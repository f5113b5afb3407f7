// Tables audit, alarms and devices. Everything throws StoreError.
#pragma once

#include <functional>

#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {

class EventTable {
 public:
  // Limit of audit entries, of alarms and of alarm events; the newest are kept.
  static constexpr std::int64_t kMaxKept = 1'000'000;

  explicit EventTable(SqlConnection& connection) : connection_(connection) {}

  void insert(const AuditEntry& entry);
  void insert(const AlarmRecord& alarm);  // an existing one is not changed
  // Replaces the record; keeps protocol and address if empty, and the time of an unchanged state.
  void insert(const DeviceRecord& device);

  // Reads entries with from <= time < to in the order of time, until the function returns false.
  void audit(UtcTime from, UtcTime to, const std::function<bool(const AuditEntry&)>& on_entry);
  // Reads the newest first, at most `limit`.
  void newest_audit(UtcTime from, UtcTime to, std::int64_t limit,
                    const std::function<void(const AuditEntry&)>& on_entry);
  void alarms(UtcTime from, UtcTime to, const std::function<bool(const AlarmRecord&)>& on_alarm);
  // Returns the alarms whose last record is active, of any bridge.
  [[nodiscard]] std::vector<AlarmRecord> active_alarms();
  [[nodiscard]] std::vector<DeviceRecord> devices();  // sorted by bus and name

  void remove_oldest();

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
