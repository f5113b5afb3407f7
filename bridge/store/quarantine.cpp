#include "bridge/store/quarantine.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/base/json.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

void QuarantineTable::insert(UtcTime at, const std::string& table, const std::string& content,
                             const std::string& reason) {
  connection_.execute(
      "insert into quarantine (at, table_name, content, reason) values ($1, $2, $3, $4)",
      SqlRow{at.nanoseconds, table, content, reason});
}

void QuarantineTable::remove_oldest() {
  connection_.execute("delete from quarantine where id <= (select max(id) from quarantine) - $1",
                      SqlRow{kMaxKept});
}

namespace {

Json json_text(const std::string& text) { return Value(text); }

Json json_value(const Value& value) {
  if (const auto* real = std::get_if<double>(&value); real != nullptr && !std::isfinite(*real))
    return number_text(*real);
  return value;
}

Json alarm_fields(const AlarmKey& alarm) {
  return {{"bus", json_text(alarm.bus)},
          {"device", json_text(alarm.device)},
          {"channel", json_text(alarm.channel)},
          {"limit_kind", to_text(alarm.limit)}};
}

RecordJson record_json(const char* table, const Json& fields) {
  return {table, ascii_json(fields)};
}

}  // namespace

std::string log_text(const AuditEntry& entry) {
  return fmt::format("{} {} {}: {} ({} bytes to the device, {} from it)", entry.who, entry.what,
                     entry.target, entry.result, entry.bytes_to_device, entry.bytes_from_device);
}
std::string log_text(const AlarmRecord& alarm) {
  return fmt::format("alarm {}/{}/{} {} {} at {}", alarm.bus, alarm.device, alarm.channel,
                     alarm.limit, alarm.state, number_text(alarm.value));
}
std::string log_text(const KeptAlarm& alarm) {
  return fmt::format("alarm {} {}", to_text(alarm.alarm), to_text(alarm.status.stage));
}
std::string log_text(const KeptMaintenance& maintenance) {
  return fmt::format("maintenance of {}/{}", maintenance.device.first, maintenance.device.second);
}
std::string log_text(const AlarmEvent& event) {
  return fmt::format("alarm {} {} by {}", to_text(event.alarm), to_text(event.kind), event.by);
}
std::string log_text(const DeviceRecord& device) {
  return fmt::format("device {}/{} {}", device.bus, device.device, device.state);
}
std::string log_text(const BusEpoch& epoch) {
  return fmt::format("bus {} began epoch {}", epoch.bus, epoch.epoch);
}

RecordJson json_of(const AuditEntry& entry) {
  return record_json("audit", {{"at", entry.at.nanoseconds},
                               {"who", json_text(entry.who)},
                               {"what", json_text(entry.what)},
                               {"target", json_text(entry.target)},
                               {"bytes_to_device", entry.bytes_to_device},
                               {"bytes_from_device", entry.bytes_from_device},
                               {"result", json_text(entry.result)}});
}

RecordJson json_of(const AlarmRecord& alarm) {
  return record_json("alarms", {{"bus", json_text(alarm.bus)},
                                {"device", json_text(alarm.device)},
                                {"channel", json_text(alarm.channel)},
                                {"limit_kind", json_text(alarm.limit)},
                                {"state", json_text(alarm.state)},
                                {"value", json_value(alarm.value)},
                                {"since", alarm.since.nanoseconds}});
}

RecordJson json_of(const KeptAlarm& kept) {
  const AlarmStatus& status = kept.status;
  Json fields = alarm_fields(kept.alarm);
  fields.add("stage", to_text(status.stage))
      .add("active", status.active)
      .add("value", json_value(status.value))
      .add("raised_at", status.raised_at.nanoseconds)
      .add("cleared_at", status.cleared_at.nanoseconds)
      .add("acknowledged_by", json_text(status.acknowledged.by))
      .add("acknowledged_at", status.acknowledged.at.nanoseconds)
      .add("acknowledged_note", json_text(status.acknowledged.note))
      .add("shelved_by", json_text(status.shelved.by))
      .add("shelved_at", status.shelved.since.nanoseconds)
      .add("shelved_until", status.shelved.until.nanoseconds)
      .add("shelved_note", json_text(status.shelved.note));
  return record_json("alarm_states", fields);
}

RecordJson json_of(const KeptMaintenance& maintenance) {
  const AlarmPause& pause = maintenance.pause;
  return record_json("device_maintenance", {{"bus", json_text(maintenance.device.first)},
                                            {"device", json_text(maintenance.device.second)},
                                            {"who", json_text(pause.by)},
                                            {"note", json_text(pause.note)},
                                            {"since", pause.since.nanoseconds},
                                            {"until", pause.until.nanoseconds}});
}

RecordJson json_of(const AlarmEvent& event) {
  Json fields = alarm_fields(event.alarm);
  fields.add("at", event.at.nanoseconds)
      .add("event", to_text(event.kind))
      .add("who", json_text(event.by))
      .add("note", json_text(event.note))
      .add("until", event.until.nanoseconds);
  return record_json("alarm_events", fields);
}

RecordJson json_of(const DeviceRecord& device) {
  return record_json("devices", {{"bus", json_text(device.bus)},
                                 {"device", json_text(device.device)},
                                 {"protocol", json_text(device.protocol)},
                                 {"address", json_text(device.address)},
                                 {"state", json_text(device.state)},
                                 {"since", device.since.nanoseconds}});
}

RecordJson json_of(const BusEpoch& epoch) {
  return record_json("bus_epochs", {{"bus", json_text(epoch.bus)}, {"epoch", epoch.epoch}});
}

RecordJson json_of(const StoredChannel& channel, const SampleRow& sample) {
  return record_json("samples", {{"bus", json_text(channel.bus)},
                                 {"device", json_text(channel.device)},
                                 {"channel", json_text(channel.channel)},
                                 {"unit", json_text(channel.unit)},
                                 {"type", json_text(channel.type)},
                                 {"published_at", sample.published_at.nanoseconds},
                                 {"sequence", sample.sequence},
                                 {"acquired_at", sample.acquired_at.nanoseconds},
                                 {"quality", static_cast<int>(sample.quality)},
                                 {"device_code", sample.device_code},
                                 {"value", json_value(sample.value)}});
}

}  // namespace fieldcast
