// Actions of users on alarms, received from DDS: refuses duplicates, applies the action, and writes
// it to audit and log. Every action ends immediately in exactly one result. Any thread.
#pragma once

#include <mutex>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/store/command_audit.hpp"
#include "core/base/time.hpp"
#include "core/bus/command/command_ledger.hpp"

namespace fieldcast {

class AlarmActions {
 public:
  // Both must outlive this object.
  AlarmActions(AlarmTable& alarms, CommandAudit& audit) : alarms_(alarms), audit_(audit) {}

  [[nodiscard]] CommandResult take(const AlarmAction& action, const UtcMapping& now);
  // Another bridge has responded; later copies are duplicates. Returns false if it already was one.
  bool completed_elsewhere(const std::string& requester, std::uint64_t request_id);

 private:
  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);

  AlarmTable& alarms_;
  CommandAudit& audit_;
  std::mutex mutex_;
  CommandLedger ledger_;
};

// For example what: "shelve high for 30min: the filter is dirty", target: "press-1/level".
[[nodiscard]] AuditEntry audit_entry(const AlarmAction& action);

}  // namespace fieldcast
