// What happened, and how devices are: audit, alarms, devices. Everything throws StoreError.
#pragma once

#include <functional>

#include "bridge/store/records.hpp"
#include "bridge/store/sql.hpp"

namespace fieldcast {

class EventTable {
 public:
  // Audit entries, and as many alarms, and events of alarms: the newest.
  static constexpr std::int64_t kMaxKept = 1'000'000;

  explicit EventTable(SqlConnection& connection) : connection_(connection) {}

  void insert(const AuditEntry& entry);
  void insert(const AlarmRecord& alarm);  // one that is there already is left alone
  // In place of what was known of it; an empty protocol or address leaves the one that is there,
  // and the state it has already its time.
  void insert(const DeviceRecord& device);

  // In the order of time, those of from <= time < to. False from the function ends it.
  void audit(UtcTime from, UtcTime to, const std::function<bool(const AuditEntry&)>& on_entry);
  // The newest of them first, `limit` at most.
  void newest_audit(UtcTime from, UtcTime to, std::int64_t limit,
                    const std::function<void(const AuditEntry&)>& on_entry);
  void alarms(UtcTime from, UtcTime to, const std::function<bool(const AlarmRecord&)>& on_alarm);
  // Those whose last record says active: they have not ended, whoever wrote them.
  [[nodiscard]] std::vector<AlarmRecord> active_alarms();
  [[nodiscard]] std::vector<DeviceRecord> devices();  // by bus and name

  void remove_oldest();  // beyond kMaxKept

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
