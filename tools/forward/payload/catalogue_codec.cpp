#include "schema/forward.pb.h"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/names.hpp"

namespace fieldcast::forward {

namespace {

void write_limits(const Limits& limits, v1::Catalogue_Limits& out) {
  if (limits.low_low) out.set_low_low(*limits.low_low);
  if (limits.low) out.set_low(*limits.low);
  if (limits.high) out.set_high(*limits.high);
  if (limits.high_high) out.set_high_high(*limits.high_high);
}

Limits read_limits(const v1::Catalogue_Limits& from) {
  Limits limits;
  if (from.has_low_low()) limits.low_low = from.low_low();
  if (from.has_low()) limits.low = from.low();
  if (from.has_high()) limits.high = from.high();
  if (from.has_high_high()) limits.high_high = from.high_high();
  return limits;
}

void write_pause(const AlarmPause& pause, v1::Alarm_Pause& out) {
  out.set_by(pause.by);
  out.set_note(pause.note);
  out.set_since(pause.since.nanoseconds);
  out.set_until(pause.until.nanoseconds);
}

AlarmPause read_pause(const v1::Alarm_Pause& from) {
  return {from.by(), from.note(), {from.since()}, {from.until()}};
}

}  // namespace

std::string encode(std::string_view site, const DeviceCatalogue& catalogue) {
  v1::Catalogue out;
  out.set_schema(kSchema);
  out.set_catalogue(identity_of(catalogue));
  out.set_site(std::string(site));
  out.set_bus(catalogue.bus);
  out.set_device(catalogue.device);
  for (const StationChannel& channel : catalogue.channels) {
    v1::Catalogue_Channel& entry = *out.add_channels();
    entry.set_channel(channel.channel);
    entry.set_type(channel.type);
    entry.set_unit(channel.unit);
    entry.set_at(channel.at);
    entry.set_description(channel.description);
    entry.set_access(std::string(to_text(channel.access)));
    entry.set_mode(std::string(to_text(channel.mode)));
    entry.set_refresh(static_cast<std::uint64_t>(channel.refresh.count()));
    const Limits& limits = channel.limits;
    if (limits.low_low || limits.low || limits.high || limits.high_high)
      write_limits(limits, *entry.mutable_limits());
    if (channel.write_min) entry.set_write_min(*channel.write_min);
    if (channel.write_max) entry.set_write_max(*channel.write_max);
  }
  return out.SerializeAsString();
}

std::optional<DeviceCatalogue> decode_catalogue(std::string_view text) {
  v1::Catalogue from;
  if (!from.ParseFromArray(text.data(), static_cast<int>(text.size())) || from.schema() != kSchema)
    return std::nullopt;
  DeviceCatalogue to{from.bus(), from.device(), {}};
  for (const v1::Catalogue_Channel& entry : from.channels()) {
    const auto access = enum_from(kAccesses, entry.access());
    const auto mode = enum_from(kModes, entry.mode());
    if (!access || !mode) return std::nullopt;
    StationChannel channel{.bus = from.bus(),
                           .device = from.device(),
                           .channel = entry.channel(),
                           .type = entry.type(),
                           .unit = entry.unit(),
                           .at = entry.at(),
                           .description = entry.description(),
                           .access = *access,
                           .mode = *mode,
                           .refresh = Duration{static_cast<std::int64_t>(entry.refresh())},
                           .limits = read_limits(entry.limits())};
    if (entry.has_write_min()) channel.write_min = entry.write_min();
    if (entry.has_write_max()) channel.write_max = entry.write_max();
    to.channels.push_back(std::move(channel));
  }
  return to;
}

std::string encode(std::string_view site, const StationAlarmStatus& alarm) {
  const AlarmStatus& status = alarm.status;
  v1::Alarm out;
  out.set_schema(kSchema);
  out.set_site(std::string(site));
  out.set_bus(alarm.alarm.bus);
  out.set_device(alarm.alarm.device);
  out.set_channel(alarm.alarm.channel);
  out.set_limit(std::string(to_text(alarm.alarm.limit)));
  out.set_priority(std::string(to_text(status.priority)));
  out.set_stage(std::string(to_text(status.stage)));
  out.set_active(status.active);
  out.set_value(status.value);
  out.set_raised_at(status.raised_at.nanoseconds);
  out.set_cleared_at(status.cleared_at.nanoseconds);
  out.set_acknowledged_by(status.acknowledged.by);
  out.set_acknowledged_note(status.acknowledged.note);
  out.set_acknowledged_at(status.acknowledged.at.nanoseconds);
  if (status.shelved.is_set()) write_pause(status.shelved, *out.mutable_shelved());
  if (status.suppressed.is_set()) write_pause(status.suppressed, *out.mutable_suppressed());
  return out.SerializeAsString();
}

std::optional<StationAlarmStatus> decode_alarm(std::string_view text) {
  v1::Alarm from;
  if (!from.ParseFromArray(text.data(), static_cast<int>(text.size())) || from.schema() != kSchema)
    return std::nullopt;
  const auto limit = limit_kind_from(from.limit());
  const auto priority = enum_from(kPriorities, from.priority());
  const auto stage = enum_from(kStages, from.stage());
  if (!limit || !priority || !stage) return std::nullopt;
  StationAlarmStatus to;
  to.alarm = {from.bus(), from.device(), from.channel(), *limit};
  to.status.priority = *priority;
  to.status.stage = *stage;
  to.status.active = from.active();
  to.status.value = from.value();
  to.status.raised_at = {from.raised_at()};
  to.status.cleared_at = {from.cleared_at()};
  to.status.acknowledged = {
      from.acknowledged_by(), from.acknowledged_note(), {from.acknowledged_at()}};
  to.status.shelved = read_pause(from.shelved());
  to.status.suppressed = read_pause(from.suppressed());
  return to;
}

}  // namespace fieldcast::forward
