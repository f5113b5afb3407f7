#include "bridge/store/command_audit.hpp"

#include <fmt/format.h>

#include "bridge/base/clock.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMaxValuesShown = 8, kMaxTextShown = 120;

std::string values_text(const std::vector<Value>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size() && i < kMaxValuesShown; ++i)
    text += ' ' + to_text(values[i]);
  if (values.size() > kMaxValuesShown) text += fmt::format(" .. ({} values)", values.size());
  return printable(text, kMaxTextShown);
}

}  // namespace

AuditEntry audit_entry(const std::string& bus, const Command& command) {
  AuditEntry entry{.who = command.subject.empty()
                              ? command.requester
                              : fmt::format("{} ({})", command.subject, command.requester)};
  entry.what =
      command.operation == Operation::kWrite ? "write" + values_text(command.values) : "acquire";
  entry.target = bus + '/' + command.device;
  if (const auto* channel = std::get_if<ChannelTarget>(&command.target)) {
    if (!channel->name.empty()) entry.target += '/' + channel->name;
  } else {
    entry.target += " at " + printable(std::get<AddressTarget>(command.target).at);
  }
  return entry;
}

void CommandAudit::open(Audit* audit) {
  const std::lock_guard lock(mutex_);
  audit_ = audit;
  pending_.clear();
}

AuditEntry CommandAudit::asked(const std::string& bus, const Command& command) {
  AuditEntry entry = audit_entry(bus, command);
  const std::lock_guard lock(mutex_);
  if (audit_ && pending_.size() < kMaxPending)
    pending_.try_emplace({command.requester, command.request_id}, entry);
  return entry;
}

void CommandAudit::refused(AuditEntry asked, const CommandResult& result) {
  const std::lock_guard lock(mutex_);
  // A duplicate must not remove the entry of the command that still runs.
  if (result.cause != Cause::kDuplicate) pending_.erase({result.requester, result.request_id});
  append(std::move(asked), result);
}

void CommandAudit::completed(const std::string& bus, const CommandResult& result) {
  const std::lock_guard lock(mutex_);
  const auto found = pending_.find({result.requester, result.request_id});
  if (found == pending_.end())
    return append({.who = result.requester, .what = "command", .target = bus}, result);
  AuditEntry entry = std::move(found->second);
  pending_.erase(found);
  append(std::move(entry), result);
}

void CommandAudit::note(AuditEntry entry) {
  const std::lock_guard lock(mutex_);
  if (audit_) audit_->append(std::move(entry));
}

void CommandAudit::note(AuditEntry asked, const CommandResult& result) {
  const std::lock_guard lock(mutex_);
  append(std::move(asked), result);
}

void CommandAudit::append(AuditEntry entry, const CommandResult& result) {
  if (!audit_) return;
  entry.at = read_clocks().utc;
  entry.result = std::string(to_text(result.state));
  if (!result.reason.empty()) entry.result += ": " + result.reason;
  audit_->append(std::move(entry));
}

}  // namespace fieldcast
