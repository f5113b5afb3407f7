#include "bridge/alarm/alarm_actions.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

AuditEntry audit_entry(const AlarmAction& action) {
  AuditEntry entry;
  entry.who = fmt::format(
      "{} ({})", action.by,
      action.subject.empty() ? action.requester : action.subject + ", " + action.requester);
  entry.target = action.alarm.bus + '/' + action.alarm.device;
  entry.what = to_text(action.kind);
  if (!is_of_device(action.kind)) {
    entry.target += '/' + action.alarm.channel;
    entry.what += fmt::format(" {}", to_text(action.alarm.limit));
  }
  if (action.kind == AlarmActionKind::kShelve || action.kind == AlarmActionKind::kMaintenance)
    entry.what += " for " + to_text(action.duration);
  if (!action.note.empty()) entry.what += ": " + action.note;
  return entry;
}

bool AlarmActions::completed_elsewhere(const std::string& requester, std::uint64_t request_id) {
  const std::lock_guard lock(mutex_);
  return ledger_.enter(requester, request_id);
}

AlarmOutcome AlarmActions::act(const AlarmAction& action, UtcTime now) {
  {
    const std::lock_guard lock(mutex_);
    if (!ledger_.enter(action.requester, action.request_id)) {
      return tl::unexpected(
          AlarmRefusal{Cause::kDuplicate, "this requester used this request_id before"});
    }
  }
  if (action.kind != AlarmActionKind::kEndSession) return alarms_.act(action, now);
  if (action.by.empty())
    return tl::unexpected(AlarmRefusal{Cause::kRange, "it must say who does it"});
  const std::string reason =
      fmt::format("ended by {}{}", action.by, action.note.empty() ? "" : ": " + action.note);
  if (!end_session_ || !end_session_(action.alarm.bus, action.alarm.device, reason))
    return tl::unexpected(AlarmRefusal{Cause::kWrongState, "nobody programs the device"});
  return {};
}

CommandResult AlarmActions::take(const AlarmAction& action, const UtcMapping& now) {
  Command asked;
  asked.requester = action.requester;
  asked.request_id = action.request_id;
  const AlarmOutcome outcome = act(action, now.utc);
  CommandResult result = rejection(asked, outcome ? Cause::kNone : outcome.error().cause,
                                   outcome ? std::string() : outcome.error().reason, now.instant);
  if (outcome) result.state = CommandState::kDone;
  AuditEntry entry = audit_entry(action);
  if (outcome)
    log_counted(LogLevel::kInfo, "alarms", "actions of users",
                fmt::format("{}: {} by {}", entry.target, entry.what, entry.who));
  audit_.note(std::move(entry), result);
  return result;
}

}  // namespace fieldcast
