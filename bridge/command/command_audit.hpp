// Who asked for which command, and what became of it: one audit entry for each, when its result is
// known. Any thread.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "bridge/store/audit.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandAudit {
 public:
  // Beyond it an entry does not say what was asked, but still who and the result.
  static constexpr std::size_t kMaxPending = 16384;

  // Where entries go from now on; null: nowhere.
  void open(Audit* audit);

  // A command came in. The entry is for refused(), and is kept for answered().
  AuditEntry asked(const std::string& bus, const Command& command);
  // It was refused before a bus had it: its key may be that of another command that still runs.
  void refused(AuditEntry asked, const CommandResult& result);
  void answered(const std::string& bus, const CommandResult& result);
  // What is answered as soon as it comes.
  void note(AuditEntry asked, const CommandResult& result);

 private:
  void append(AuditEntry entry, const CommandResult& result);

  std::mutex mutex_;
  Audit* audit_ = nullptr;
  std::map<std::pair<std::string, std::uint64_t>, AuditEntry> pending_;
};

// "write 21.5", "press-shop/press-1/setpoint": what and target of a command's entry.
[[nodiscard]] AuditEntry audit_entry(const std::string& bus, const Command& command);

}  // namespace fieldcast
