#include <fastcdr/exceptions/BadParamException.h>

#include <algorithm>

#include "bridge/dds/topics/conversion.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {

std::string cut_text(std::string_view text, std::size_t limit) {
  text = text.substr(0, text.find('\0'));
  if (text.size() <= limit) return std::string(text);
  std::size_t end = limit;
  // never cut inside a character
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return std::string(text.substr(0, end));
}

bool to_idl(const Value& value, idl::Value& out) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (text->size() > kMaxTextValue || text->find('\0') != std::string::npos) return false;
    out.string_value(text->c_str());
  } else if (const auto* on = std::get_if<bool>(&value)) {
    out.boolean_value(*on);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out.int64_value(*whole);
  } else if (const auto* natural = std::get_if<std::uint64_t>(&value)) {
    out.uint64_value(*natural);
  } else {
    out.double_value(std::get<double>(value));
  }
  return true;
}

std::optional<Value> from_idl(const idl::Value& value) try {
  switch (value._d()) {
    case idl::ValueKind::VALUE_BOOLEAN: return value.boolean_value();
    case idl::ValueKind::VALUE_INT64: return std::int64_t{value.int64_value()};
    case idl::ValueKind::VALUE_UINT64: return std::uint64_t{value.uint64_value()};
    case idl::ValueKind::VALUE_DOUBLE: return value.double_value();
    case idl::ValueKind::VALUE_STRING: return std::string(value.string_value().c_str());
  }
  return std::nullopt;
} catch (const eprosima::fastcdr::exception::BadParamException&) {
  return std::nullopt;  // Fast DDS 3 keeps the kind, but no member, of a value of an unknown kind
}

void to_idl(const Sample& sample, const UtcMapping& mapping, idl::Sample& out) {
  if (to_idl(sample.value, out.value())) {
    out.quality(to_idl(sample.quality));
  } else {
    out.value().string_value("");
    out.quality(idl::Quality::BAD_RANGE);
  }
  out.device_code(sample.device_code);
  out.acquired_at(mapping.to_utc(sample.acquired).nanoseconds);
  out.sequence(sample.sequence);
}

std::optional<StationSample> from_idl(const idl::Sample& sample) {
  std::optional<Value> value = from_idl(sample.value());
  const auto quality = from_idl(sample.quality());
  if (!value || !quality) return std::nullopt;
  StationSample out;
  out.bus = sample.bus().c_str();
  out.device = sample.device().c_str();
  out.channel = sample.channel().c_str();
  out.value = std::move(*value);
  out.quality = *quality;
  out.device_code = sample.device_code();
  out.acquired_at = {sample.acquired_at()};
  out.sequence = sample.sequence();
  return out;
}

namespace {

void add_limit(std::vector<idl::Limit>& limits, idl::LimitKind kind,
               const std::optional<double>& value) {
  if (!value) return;
  limits.emplace_back();
  limits.back().kind(kind);
  limits.back().value(*value);
}

}  // namespace

void to_idl(std::string_view bridge, std::string_view bus, const DeviceSpec& device,
            const ChannelSpec& channel, std::optional<Duration> refresh, idl::Channel& out) {
  out.bus() = cut_text(bus, kMaxNameLength);
  out.device() = cut_text(device.name, kMaxNameLength);
  out.channel() = cut_text(channel.name, kMaxNameLength);
  out.bridge() = cut_text(bridge, kMaxNameLength);
  out.type() = to_text(channel.encoding);
  out.unit() = cut_text(channel.unit, 32);
  out.at() = cut_text(channel.at, 128);
  out.access(to_idl(channel.access));
  out.mode(to_idl(channel.mode));
  out.refresh(refresh.value_or(Duration::zero()).count());
  auto& limits = out.limits();
  limits.clear();
  add_limit(limits, idl::LimitKind::LIMIT_LOW_LOW, channel.limits.low_low);
  add_limit(limits, idl::LimitKind::LIMIT_LOW, channel.limits.low);
  add_limit(limits, idl::LimitKind::LIMIT_HIGH, channel.limits.high);
  add_limit(limits, idl::LimitKind::LIMIT_HIGH_HIGH, channel.limits.high_high);
  add_limit(limits, idl::LimitKind::LIMIT_WRITE_MIN, channel.write_min);
  add_limit(limits, idl::LimitKind::LIMIT_WRITE_MAX, channel.write_max);
  out.description() = cut_text(channel.description, 256);
}

StationChannel from_idl(const idl::Channel& channel) {
  StationChannel out;
  out.bridge = channel.bridge().c_str();
  out.bus = channel.bus().c_str();
  out.device = channel.device().c_str();
  out.channel = channel.channel().c_str();
  out.type = channel.type().c_str();
  out.unit = channel.unit().c_str();
  out.at = channel.at().c_str();
  out.description = channel.description().c_str();
  out.access = from_idl(channel.access()).value_or(Access::kReadOnly);
  out.mode = from_idl(channel.mode()).value_or(Mode::kScheduled);
  out.refresh = Duration{channel.refresh()};
  for (const idl::Limit& limit : channel.limits()) {
    switch (limit.kind()) {
      case idl::LimitKind::LIMIT_LOW_LOW: out.limits.low_low = limit.value(); break;
      case idl::LimitKind::LIMIT_LOW: out.limits.low = limit.value(); break;
      case idl::LimitKind::LIMIT_HIGH: out.limits.high = limit.value(); break;
      case idl::LimitKind::LIMIT_HIGH_HIGH: out.limits.high_high = limit.value(); break;
      case idl::LimitKind::LIMIT_WRITE_MIN: out.write_min = limit.value(); break;
      case idl::LimitKind::LIMIT_WRITE_MAX: out.write_max = limit.value(); break;
    }
  }
  return out;
}

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
