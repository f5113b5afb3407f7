// Alarms: topic type from core type and back.
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

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

}  // namespace fieldcast
