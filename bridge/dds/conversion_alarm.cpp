// Alarms: topic type from core type and back.
#include "bridge/dds/conversion.hpp"

namespace fieldcast {

static_assert(static_cast<int>(idl::LIMIT_LOW_LOW) == static_cast<int>(LimitKind::kLowLow));
static_assert(static_cast<int>(idl::LIMIT_HIGH_HIGH) == static_cast<int>(LimitKind::kHighHigh));
static_assert(static_cast<int>(idl::ALARM_ACTIVE) == static_cast<int>(AlarmState::kActive));

void to_idl(const AlarmChange& change, const UtcMapping& mapping, idl::Alarm& out) {
  out.limit(static_cast<idl::LimitKind>(change.limit));
  out.state(static_cast<idl::AlarmState>(change.state));
  out.value(change.value);
  out.since(mapping.to_utc(change.since).nanoseconds);
}

std::optional<StationAlarm> from_idl(const idl::Alarm& alarm) {
  if (alarm.limit() > idl::LIMIT_HIGH_HIGH || alarm.state() > idl::ALARM_ACTIVE) return std::nullopt;
  return StationAlarm{alarm.bus().c_str(),
                      alarm.device().c_str(),
                      alarm.channel().c_str(),
                      static_cast<LimitKind>(alarm.limit()),
                      static_cast<AlarmState>(alarm.state()),
                      alarm.value(),
                      UtcTime{alarm.since()}};
}

}  // namespace fieldcast
