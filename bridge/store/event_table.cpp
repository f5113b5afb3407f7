#include "bridge/store/event_table.hpp"

#include <fmt/format.h>

#include "core/alarm/alarm_status.hpp"

namespace fieldcast {
namespace {

AlarmRecord alarm_of(const SqlRow& row) {
  const auto* value = std::get_if<double>(&row.at(5));
  return {text_at(row, 0),
          text_at(row, 1),
          text_at(row, 2),
          text_at(row, 3),
          text_at(row, 4),
          value == nullptr ? 0 : *value,
          UtcTime{integer_at(row, 6)}};
}

AuditEntry entry_of(const SqlRow& row) {
  return {.at = UtcTime{integer_at(row, 0)},
          .who = text_at(row, 1),
          .what = text_at(row, 2),
          .target = text_at(row, 3),
          .bytes_to_device = static_cast<std::uint64_t>(integer_at(row, 4)),
          .bytes_from_device = static_cast<std::uint64_t>(integer_at(row, 5)),
          .result = text_at(row, 6)};
}

}  // namespace

void EventTable::insert(const AuditEntry& entry) {
  connection_.execute(
      "insert into audit (at, who, what, target, bytes_to_device, bytes_from_device, result) "
      "values ($1, $2, $3, $4, $5, $6, $7)",
      SqlRow{entry.at.nanoseconds, entry.who, entry.what, entry.target,
             static_cast<std::int64_t>(entry.bytes_to_device),
             static_cast<std::int64_t>(entry.bytes_from_device), entry.result});
}

void EventTable::insert(const AlarmRecord& alarm) {
  connection_.execute(
      "insert into alarms (bus, device, channel, limit_kind, state, value, since) select "
      "cast($1 as text), cast($2 as text), cast($3 as text), cast($4 as text), cast($5 as text), "
      "cast($6 as double precision), cast($7 as bigint) where not exists (select 1 from alarms "
      "where since = $7 and bus = $1 and device = $2 and channel = $3 and limit_kind = $4 and "
      "state = $5)",
      SqlRow{alarm.bus, alarm.device, alarm.channel, alarm.limit, alarm.state, alarm.value,
             alarm.since.nanoseconds});
}

void EventTable::insert(const DeviceRecord& device) {
  connection_.execute(
      "insert into devices (bus, device, protocol, address, state, since) values ($1, $2, $3, $4, "
      "$5, $6) on conflict (bus, device) do update set "
      "protocol = case excluded.protocol when '' then devices.protocol else excluded.protocol end, "
      "address = case excluded.address when '' then devices.address else excluded.address end, "
      "since = case excluded.state when devices.state then devices.since else excluded.since end, "
      "state = excluded.state",
      SqlRow{device.bus, device.device, device.protocol, device.address, device.state,
             device.since.nanoseconds});
}

void EventTable::audit(UtcTime from, UtcTime to,
                       const std::function<bool(const AuditEntry&)>& on_entry) {
  connection_.query(
      "select at, who, what, target, bytes_to_device, bytes_from_device, result from audit where "
      "at >= $1 and at < $2 "
      "order by at, id",
      {from.nanoseconds, to.nanoseconds},
      [&](const SqlRow& row) { return on_entry(entry_of(row)); });
}

void EventTable::newest_audit(UtcTime from, UtcTime to, std::int64_t limit,
                              const std::function<void(const AuditEntry&)>& on_entry) {
  connection_.query(
      "select at, who, what, target, bytes_to_device, bytes_from_device, result from audit where "
      "at >= $1 and at < $2 order by at desc, id desc limit $3",
      {from.nanoseconds, to.nanoseconds, limit}, [&](const SqlRow& row) {
        on_entry(entry_of(row));
        return true;
      });
}

void EventTable::alarms(UtcTime from, UtcTime to,
                        const std::function<bool(const AlarmRecord&)>& on_alarm) {
  connection_.query(
      "select bus, device, channel, limit_kind, state, value, since from alarms where since >= $1 "
      "and since < $2 order by since, "
      "id",
      {from.nanoseconds, to.nanoseconds},
      [&](const SqlRow& row) { return on_alarm(alarm_of(row)); });
}

std::vector<AlarmRecord> EventTable::active_alarms() {
  std::vector<AlarmRecord> found;
  connection_.query(
      "select bus, device, channel, limit_kind, state, value, since from alarms where id in "
      "(select max(id) from alarms group by bus, device, channel, limit_kind) and state = $1 "
      "order by id",
      {std::string(to_text(AlarmState::kActive))}, [&](const SqlRow& row) {
        found.push_back(alarm_of(row));
        return true;
      });
  return found;
}

std::vector<DeviceRecord> EventTable::devices() {
  std::vector<DeviceRecord> found;
  connection_.query(
      "select bus, device, protocol, address, state, since from devices order by bus, device", {},
      [&](const SqlRow& row) {
        found.push_back({text_at(row, 0), text_at(row, 1), text_at(row, 2), text_at(row, 3),
                         text_at(row, 4), UtcTime{integer_at(row, 5)}});
        return true;
      });
  return found;
}

void EventTable::remove_oldest() {
  for (const char* const table : {"audit", "alarms", "alarm_events"}) {
    const std::string name(table);
    connection_.execute(
        fmt::format("delete from {} where id <= (select max(id) from {}) - $1", name, name),
        SqlRow{kMaxKept});
  }
}

}  // namespace fieldcast
