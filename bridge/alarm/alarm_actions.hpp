// Actions of users on alarms and programming sessions, received from DDS: refuses duplicates,
// applies the action, and writes it to audit and log. Every action ends immediately in exactly one
// result. Any thread.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <utility>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/store/command_audit.hpp"
#include "core/base/time.hpp"
#include "core/bus/command/command_ledger.hpp"

namespace fieldcast {

class AlarmActions {
 public:
  // Ends the programming session of a device; `reason` is for the engineer. False: there is none.
  using EndSession = std::function<bool(const std::string& bus, const std::string& device,
                                        const std::string& reason)>;
  // Both references must outlive this object. Without `end_session` there are no sessions.
  AlarmActions(AlarmTable& alarms, CommandAudit& audit, EndSession end_session = {})
      : alarms_(alarms), audit_(audit), end_session_(std::move(end_session)) {}

  [[nodiscard]] CommandResult take(const AlarmAction& action, const UtcMapping& now);
  // Another bridge has responded; later copies are duplicates. Returns false if it already was one.
  bool completed_elsewhere(const std::string& requester, std::uint64_t request_id);

 private:
  [[nodiscard]] AlarmOutcome act(const AlarmAction& action, UtcTime now);

  AlarmTable& alarms_;
  CommandAudit& audit_;
  const EndSession end_session_;
  std::mutex mutex_;
  CommandLedger ledger_;
};

// For example what: "shelve high for 30min: the filter is dirty", target: "press-1/level".
[[nodiscard]] AuditEntry audit_entry(const AlarmAction& action);

}  // namespace fieldcast
