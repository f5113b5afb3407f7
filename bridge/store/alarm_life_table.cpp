#include "bridge/store/alarm_life_table.hpp"

#include "bridge/store/event_table.hpp"

namespace fieldcast {
namespace {

UtcTime time_at(const SqlRow& row, std::size_t column) { return {integer_at(row, column)}; }

double real_at(const SqlRow& row, std::size_t column) {
  const auto* value = std::get_if<double>(&row.at(column));
  return value == nullptr ? 0 : *value;
}

std::optional<AlarmKey> key_at(const SqlRow& row) {
  const auto limit = limit_kind_from(text_at(row, 3));
  if (!limit) return std::nullopt;
  return AlarmKey{text_at(row, 0), text_at(row, 1), text_at(row, 2), *limit};
}

SqlRow keys_of(const AlarmKey& alarm) {
  return {alarm.bus, alarm.device, alarm.channel, std::string(to_text(alarm.limit))};
}

AlarmStage stage_from(const std::string& text) {
  for (const AlarmStage stage :
       {AlarmStage::kUnacknowledged, AlarmStage::kAcknowledged, AlarmStage::kReturned}) {
    if (text == to_text(stage)) return stage;
  }
  return AlarmStage::kClear;
}

AlarmLogEntry log_entry_of(const SqlRow& row) {
  AlarmLogEntry entry{text_at(row, 0), text_at(row, 1), text_at(row, 2), text_at(row, 3),
                      text_at(row, 4)};
  if (const auto* value = std::get_if<double>(&row.at(5))) entry.value = *value;
  entry.who = text_at(row, 6);
  entry.note = text_at(row, 7);
  entry.at = time_at(row, 8);
  entry.until = time_at(row, 9);
  return entry;
}

}  // namespace

void AlarmLifeTable::insert(const KeptAlarm& alarm) {
  const AlarmStatus& status = alarm.status;
  SqlRow row = keys_of(alarm.alarm);
  if (status.stage == AlarmStage::kClear && !status.active && !status.shelved.is_set()) {
    connection_.execute(
        "delete from alarm_states where bus = $1 and device = $2 and channel = $3 and "
        "limit_kind = $4",
        row);
    return;
  }
  const SqlValue more[] = {std::string(to_text(status.stage)),
                           std::int64_t{status.active ? 1 : 0},
                           status.value,
                           status.raised_at.nanoseconds,
                           status.cleared_at.nanoseconds,
                           status.acknowledged.by,
                           status.acknowledged.at.nanoseconds,
                           status.acknowledged.note,
                           status.shelved.by,
                           status.shelved.since.nanoseconds,
                           status.shelved.until.nanoseconds,
                           status.shelved.note};
  row.insert(row.end(), std::begin(more), std::end(more));
  connection_.execute(
      "insert into alarm_states (bus, device, channel, limit_kind, stage, active, value, "
      "raised_at, cleared_at, acknowledged_by, acknowledged_at, acknowledged_note, shelved_by, "
      "shelved_at, shelved_until, shelved_note) values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, "
      "$11, $12, $13, $14, $15, $16) on conflict (bus, device, channel, limit_kind) do update set "
      "stage = excluded.stage, active = excluded.active, value = excluded.value, raised_at = "
      "excluded.raised_at, cleared_at = excluded.cleared_at, acknowledged_by = "
      "excluded.acknowledged_by, acknowledged_at = excluded.acknowledged_at, acknowledged_note = "
      "excluded.acknowledged_note, shelved_by = excluded.shelved_by, shelved_at = "
      "excluded.shelved_at, shelved_until = excluded.shelved_until, shelved_note = "
      "excluded.shelved_note",
      row);
}

void AlarmLifeTable::insert(const KeptMaintenance& maintenance) {
  const auto& [bus, device] = maintenance.device;
  const AlarmPause& pause = maintenance.pause;
  if (!pause.is_set()) {
    connection_.execute("delete from device_maintenance where bus = $1 and device = $2",
                        SqlRow{bus, device});
    return;
  }
  connection_.execute(
      "insert into device_maintenance (bus, device, who, note, since, until) values ($1, $2, $3, "
      "$4, $5, $6) on conflict (bus, device) do update set who = excluded.who, note = "
      "excluded.note, since = excluded.since, until = excluded.until",
      SqlRow{bus, device, pause.by, pause.note, pause.since.nanoseconds, pause.until.nanoseconds});
}

void AlarmLifeTable::insert(const AlarmEvent& event) {
  const bool of_device = event.alarm.channel.empty();
  connection_.execute(
      "insert into alarm_events (at, bus, device, channel, limit_kind, event, who, note, until) "
      "select cast($1 as bigint), cast($2 as text), cast($3 as text), cast($4 as text), "
      "cast($5 as text), cast($6 as text), cast($7 as text), cast($8 as text), "
      "cast($9 as bigint) where not exists (select 1 from alarm_events where at = $1 and bus = $2 "
      "and device = $3 and channel = $4 and limit_kind = $5 and event = $6)",
      SqlRow{event.at.nanoseconds, event.alarm.bus, event.alarm.device, event.alarm.channel,
             of_device ? std::string() : std::string(to_text(event.alarm.limit)),
             std::string(to_text(event.kind)), event.by, event.note, event.until.nanoseconds});
}

KeptAlarms AlarmLifeTable::kept(UtcTime now) {
  KeptAlarms kept;
  for (const AlarmRecord& record : EventTable(connection_).active_alarms()) {
    const auto limit = limit_kind_from(record.limit);
    if (!limit) continue;
    KeptAlarm& alarm = kept.active.emplace_back();
    alarm.alarm = {record.bus, record.device, record.channel, *limit};
    alarm.status.value = record.value;
    alarm.status.raised_at = record.since;
  }
  connection_.query(
      "select bus, device, channel, limit_kind, stage, active, value, raised_at, cleared_at, "
      "acknowledged_by, acknowledged_at, acknowledged_note, shelved_by, shelved_at, shelved_until, "
      "shelved_note from alarm_states",
      {}, [&](const SqlRow& row) {
        if (auto key = key_at(row)) {
          AlarmStatus status;
          status.stage = stage_from(text_at(row, 4));
          status.active = integer_at(row, 5) != 0;
          status.value = real_at(row, 6);
          status.raised_at = time_at(row, 7);
          status.cleared_at = time_at(row, 8);
          status.acknowledged = {text_at(row, 9), text_at(row, 11), time_at(row, 10)};
          status.shelved = {text_at(row, 12), text_at(row, 15), time_at(row, 13), time_at(row, 14)};
          kept.states.push_back({*std::move(key), std::move(status)});
        }
        return true;
      });
  connection_.query("select bus, device, who, note, since, until from device_maintenance", {},
                    [&](const SqlRow& row) {
                      kept.maintenance.push_back(
                          {{text_at(row, 0), text_at(row, 1)},
                           {text_at(row, 2), text_at(row, 3), time_at(row, 4), time_at(row, 5)}});
                      return true;
                    });
  connection_.query(
      "select bus, device, channel, limit_kind, since from alarms where since > $1 and state = $2 "
      "order by since, id",
      {now.nanoseconds - AlarmLife::kChatterWindow.count(),
       std::string(to_text(AlarmState::kActive))},
      [&](const SqlRow& row) {
        if (auto key = key_at(row)) kept.occurrences.emplace_back(*std::move(key), time_at(row, 4));
        return true;
      });
  return kept;
}

void AlarmLifeTable::log(UtcTime from, UtcTime to,
                         const std::function<bool(const AlarmLogEntry&)>& on_entry) {
  connection_.query(
      "select bus, device, channel, limit_kind, event, value, who, note, at_ns, until_ns from "
      "alarm_log where at_ns >= $1 and at_ns < $2 order by at_ns, id",
      {from.nanoseconds, to.nanoseconds},
      [&](const SqlRow& row) { return on_entry(log_entry_of(row)); });
}

void AlarmLifeTable::newest_log(UtcTime from, UtcTime to, std::int64_t limit,
                                const std::function<void(const AlarmLogEntry&)>& on_entry) {
  connection_.query(
      "select bus, device, channel, limit_kind, event, value, who, note, at_ns, until_ns from "
      "alarm_log where at_ns >= $1 and at_ns < $2 order by at_ns desc, id desc limit $3",
      {from.nanoseconds, to.nanoseconds, limit}, [&](const SqlRow& row) {
        on_entry(log_entry_of(row));
        return true;
      });
}

}  // namespace fieldcast
