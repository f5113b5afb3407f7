// What people do about alarms, from DDS: refuses duplicates, asks the alarms, notes it in the audit
// and in the log. Every action ends in exactly one result, at once. Any thread.
#pragma once

#include <mutex>

#include "bridge/command/command_audit.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"
#include "bridge/publish/alarm_table.hpp"
#include "core/bus/command_ledger.hpp"

namespace fieldcast {

class AlarmActions {
 public:
  // Both outlive it.
  AlarmActions(AlarmTable& alarms, CommandAudit& audit) : alarms_(alarms), audit_(audit) {}

  [[nodiscard]] CommandResult take(const AlarmAction& action, const UtcMapping& now);
  // It has been answered without it: it is a duplicate from here on. False: it was one before.
  bool answered_elsewhere(const std::string& requester, std::uint64_t request_id);

 private:
  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);

  AlarmTable& alarms_;
  CommandAudit& audit_;
  std::mutex mutex_;
  CommandLedger ledger_;
};

// "anna (fieldcast-cli:71:9)", "shelve high for 30min: the filter is dirty",
// "press-shop/press-1/level": who, what and target of an action's entry.
[[nodiscard]] AuditEntry audit_entry(const AlarmAction& action);

}  // namespace fieldcast
