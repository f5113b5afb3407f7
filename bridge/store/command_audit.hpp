// Writes one audit entry with requester and result for each command. Any thread.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "bridge/store/records/records.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandAudit {
 public:
  // Limit of pending commands; further entries have requester and result, but not the command.
  static constexpr std::size_t kMaxPending = 16384;

  // Sets the destination of entries; null: none.
  void open(Audit* audit);

  // Call for each received command. Pass the entry to refused(); a copy is kept for completed().
  AuditEntry asked(const std::string& bus, const Command& command);
  // Refused before a bus had it. Its key may be that of another command that still runs.
  void refused(AuditEntry asked, const CommandResult& result);
  void completed(const std::string& bus, const CommandResult& result);
  void note(AuditEntry entry);  // a complete one
  // For requests that get their result immediately.
  void note(AuditEntry asked, const CommandResult& result);

 private:
  void append(AuditEntry entry, const CommandResult& result);

  std::mutex mutex_;
  Audit* audit_ = nullptr;
  std::map<std::pair<std::string, std::uint64_t>, AuditEntry> pending_;
};

// Entry of a command: what "write 21.5", target "press-shop/press-1/setpoint".
[[nodiscard]] AuditEntry audit_entry(const std::string& bus, const Command& command);

}  // namespace fieldcast
