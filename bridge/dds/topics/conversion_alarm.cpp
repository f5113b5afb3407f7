#include "bridge/dds/topics/conversion.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMaxBy = 64, kMaxNote = 256, kMaxActor = 128;  // bytes, as in the IDL

void to_idl(const AlarmNote& note, idl::AlarmNote& out) {
  out.by() = cut_text(note.by, kMaxBy);
  out.note() = cut_text(note.note, kMaxNote);
  out.at(note.at.nanoseconds);
}

AlarmNote from_idl(const idl::AlarmNote& note) {
  return {note.by().c_str(), note.note().c_str(), UtcTime{note.at()}};
}

void to_idl(const AlarmPause& pause, idl::AlarmPause& out) {
  out.by() = cut_text(pause.by, kMaxBy);
  out.note() = cut_text(pause.note, kMaxNote);
  out.since(pause.since.nanoseconds);
  out.until(pause.until.nanoseconds);
}

AlarmPause from_idl(const idl::AlarmPause& pause) {
  return {pause.by().c_str(), pause.note().c_str(), UtcTime{pause.since()}, UtcTime{pause.until()}};
}

}  // namespace

void to_idl(const AlarmChange& change, const UtcMapping& mapping, idl::Alarm& out) {
  out.limit(to_idl(change.limit));
  out.state(to_idl(change.state));
  out.value(change.value);
  out.since(mapping.to_utc(change.since).nanoseconds);
}

std::optional<StationAlarm> from_idl(const idl::Alarm& alarm) {
  const auto limit = from_idl(alarm.limit());
  const auto state = from_idl(alarm.state());
  if (!limit || !state) return std::nullopt;
  return StationAlarm{
      alarm.bus().c_str(), alarm.device().c_str(), alarm.channel().c_str(), *limit, *state,
      alarm.value(),       UtcTime{alarm.since()}};
}

void to_idl(const AlarmKey& alarm, const AlarmStatus& status, idl::AlarmStatus& out) {
  out.bus() = cut_text(alarm.bus, kMaxNameLength);
  out.device() = cut_text(alarm.device, kMaxNameLength);
  out.channel() = cut_text(alarm.channel, kMaxNameLength);
  out.limit(to_idl(alarm.limit));
  out.priority(to_idl(status.priority));
  out.stage(to_idl(status.stage));
  out.active(status.active);
  out.value(status.value);
  out.raised_at(status.raised_at.nanoseconds);
  out.cleared_at(status.cleared_at.nanoseconds);
  out.occurrences(status.occurrences);
  out.chattering(status.chattering);
  to_idl(status.acknowledged, out.acknowledged());
  to_idl(status.shelved, out.shelved());
  to_idl(status.suppressed, out.suppressed());
}

std::optional<StationAlarmStatus> from_idl(const idl::AlarmStatus& status) {
  const auto limit = from_idl(status.limit());
  const auto priority = from_idl(status.priority());
  const auto stage = from_idl(status.stage());
  if (!limit || !priority || !stage) return std::nullopt;
  StationAlarmStatus out;
  out.alarm = {status.bus().c_str(), status.device().c_str(), status.channel().c_str(), *limit};
  out.status = {.priority = *priority,
                .stage = *stage,
                .active = status.active(),
                .value = status.value(),
                .raised_at = UtcTime{status.raised_at()},
                .cleared_at = UtcTime{status.cleared_at()},
                .occurrences = status.occurrences(),
                .chattering = status.chattering(),
                .acknowledged = from_idl(status.acknowledged()),
                .shelved = from_idl(status.shelved()),
                .suppressed = from_idl(status.suppressed())};
  return out;
}

bool to_idl(const AlarmAction& action, idl::AlarmAction& out) {
  const AlarmKey& alarm = action.alarm;
  if (alarm.bus.size() > kMaxNameLength || alarm.device.size() > kMaxNameLength ||
      alarm.channel.size() > kMaxNameLength || action.requester.size() > kMaxActor ||
      action.by.size() > kMaxBy || action.note.size() > kMaxNote) {
    return false;
  }
  out.requester() = action.requester;
  out.request_id(action.request_id);
  out.kind(to_idl(action.kind));
  out.bus() = alarm.bus;
  out.device() = alarm.device;
  out.channel() = alarm.channel;
  out.limit(to_idl(alarm.limit));
  out.by() = action.by;
  out.note() = action.note;
  out.duration(action.duration.count());
  out.raised_at(action.raised_at.nanoseconds);
  return true;
}

tl::expected<AlarmAction, MalformedCommand> from_idl(const idl::AlarmAction& action) {
  const auto kind = from_idl(action.kind());
  if (!kind) return tl::unexpected(MalformedCommand{Cause::kUnsupported, "unknown action"});
  const auto limit = from_idl(action.limit());
  if (!limit && !is_of_device(*kind))
    return tl::unexpected(MalformedCommand{Cause::kUnknownChannel, "this limit is no alarm's"});
  AlarmAction out;
  out.requester = action.requester().c_str();
  out.request_id = action.request_id();
  out.kind = *kind;
  out.alarm = {action.bus().c_str(), action.device().c_str(), action.channel().c_str(),
               limit.value_or(LimitKind::kHigh)};
  out.by = printable(action.by().c_str(), kMaxBy);
  out.note = printable(action.note().c_str(), kMaxNote);
  out.duration = Duration{action.duration()};
  out.raised_at = UtcTime{action.raised_at()};
  return out;
}

}  // namespace fieldcast
