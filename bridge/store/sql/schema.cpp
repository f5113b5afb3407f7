#include "bridge/store/sql/schema.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string_view>

#include "bridge/base/check.hpp"

namespace fieldcast {
namespace {

// Step i upgrades the store from version i to i + 1. Add steps, but never change one: existing
// stores have already applied them. Braces contain phrases (kPhrases).
constexpr const char* kSteps[] = {
    R"(
create table channels (
  id {id}, bus text not null, device text not null, channel text not null, unit text not null,
  unique (bus, device, channel));

-- value_kind 0 boolean, 1 int64, 2 uint64 (as the int64 of the same bits), 3 double (null: not a
-- number), 4 string. Times are UTC in nanoseconds. published_at orders what happened, acquired_at
-- says how old the value is.
create table samples (
  channel bigint not null, published_at bigint not null, sequence bigint not null,
  acquired_at bigint not null,
  quality smallint not null, device_code integer not null, value_kind smallint not null,
  integer_value bigint, real_value double precision, text_value text,
  primary key (channel, published_at, sequence)) {clustered};

create table users (
  name text primary key, role text not null, password_hash text not null,
  created_at bigint not null);

create table devices (
  bus text not null, device text not null, protocol text not null, address text not null,
  state text not null, since bigint not null, primary key (bus, device));

create table alarms (
  id {id}, bus text not null, device text not null, channel text not null, limit_kind text not null,
  state text not null, value double precision not null, since bigint not null);
create index alarms_since on alarms (since);

create table audit (
  id {id}, at bigint not null, who text not null, what text not null, target text not null,
  bytes_to_device bigint not null, bytes_from_device bigint not null, result text not null);
create index audit_at on audit (at);
)",
    // A float32 is written with fewer digits than the double that stores it.
    "alter table channels add column type text not null default ''",
    R"(
-- Commands that were taken, noted before they run; request_id as the int64 of the same bits.
create table commands (
  requester text not null, request_id bigint not null, taken_at bigint not null,
  primary key (requester, request_id)) {clustered};
create index commands_taken_at on commands (taken_at);
)",
    // For users and Grafana; docs/store.md describes every column. SQLite reads the tables of a
    // cross join in their order: channel by channel, by the key of samples.
    R"(
create view sample_history as
select c.bus, c.device, c.channel, c.unit, c.type, {time s.published_at} as published_at,
  {time s.acquired_at} as acquired_at, s.sequence, {quality s.quality} as quality, s.device_code,
  {value} as value, s.text_value as text, s.published_at as published_ns
from channels c cross join samples s where s.channel = c.id;

create view last_samples as
select c.bus, c.device, c.channel, c.unit, c.type, {time s.published_at} as published_at,
  {time s.acquired_at} as acquired_at, s.sequence, {quality s.quality} as quality, s.device_code,
  {value} as value, s.text_value as text, s.published_at as published_ns
from channels c {last sample};

create view device_states as
select bus, device, protocol, address, state, {time since} as since from devices;

create view alarm_history as
select id, bus, device, channel, limit_kind, state, value, {time since} as since,
  since as since_ns
from alarms;

create view active_alarms as
select bus, device, channel, limit_kind, value, {time since} as since, since as since_ns
from alarms where state = 'active' and id in (
  select max(id) from alarms group by bus, device, channel, limit_kind);

create view audit_history as
select id, {time at} as at, who, what, target, bytes_to_device, bytes_from_device, result,
  at as at_ns
from audit;
)",
    // width in seconds, start in nanoseconds (core/base/time.hpp). open_buckets: buckets whose row
    // is not written yet. untiered: channels that have samples without tiers, from `next` on.
    R"(
create table tiers (
  width bigint not null, channel bigint not null, start bigint not null,
  count bigint not null, bad bigint not null,
  min double precision, max double precision, sum double precision,
  first double precision, last double precision,
  primary key (width, channel, start)) {clustered};
create table open_buckets (
  width bigint not null, start bigint not null, channel bigint not null,
  primary key (width, start, channel)) {clustered};
create table untiered (channel bigint primary key, next bigint not null);
insert into untiered select id, 0 from channels where type <> 'string';

create view minute_history as
select c.bus, c.device, c.channel, c.unit, c.type, {time t.start} as start, {totals}
from channels c cross join tiers t where t.channel = c.id and t.width = 60;

create view hour_history as
select c.bus, c.device, c.channel, c.unit, c.type, {time t.start} as start, {totals}
from channels c cross join tiers t where t.channel = c.id and t.width = 3600;
)",
    // alarm_states: each alarm that is not clear in every respect; a time of 0 means none.
    // alarm_events: events other than that a limit was exceeded or is met again; without a channel
    // for all alarms of a device.
    R"(
create table alarm_states (
  bus text not null, device text not null, channel text not null, limit_kind text not null,
  stage text not null, active smallint not null, value double precision not null,
  raised_at bigint not null, cleared_at bigint not null,
  acknowledged_by text not null, acknowledged_at bigint not null, acknowledged_note text not null,
  shelved_by text not null, shelved_at bigint not null, shelved_until bigint not null,
  shelved_note text not null,
  primary key (bus, device, channel, limit_kind));
create table device_maintenance (
  bus text not null, device text not null, who text not null, note text not null,
  since bigint not null, until bigint not null, primary key (bus, device));
create table alarm_events (
  id {id}, at bigint not null, bus text not null, device text not null, channel text not null,
  limit_kind text not null, event text not null, who text not null, note text not null,
  until bigint not null);
create index alarm_events_at on alarm_events (at);

create view alarm_list as
select a.bus, a.device, a.channel, a.limit_kind, a.stage, a.active, a.value,
  {time a.raised_at} as raised_at, {time a.cleared_at} as cleared_at,
  a.acknowledged_by, {time a.acknowledged_at} as acknowledged_at, a.acknowledged_note,
  a.shelved_by, {time a.shelved_until} as shelved_until, a.shelved_note,
  m.who as maintenance_by, {time m.until} as maintenance_until, m.note as maintenance_note
from alarm_states a left join device_maintenance m on m.bus = a.bus and m.device = a.device;

create view maintenance_list as
select bus, device, who, note, {time since} as since, {time until} as until
from device_maintenance;

create view alarm_log as
select id, {time since} as at, bus, device, channel, limit_kind,
  case state when 'active' then 'raised' else 'cleared' end as event, value,
  '' as who, '' as note, {time 0} as until, since as at_ns, 0 as until_ns
from alarms
union all
select id, {time at} as at, bus, device, channel, limit_kind, event,
  cast(null as double precision) as value, who, note, {time until} as until, at as at_ns,
  until as until_ns
from alarm_events;
)",
    // Tokens for read access at a station without a password (token_table.hpp).
    R"(
create table tokens (
  name text primary key, hash text not null, created_at bigint not null,
  ends_at bigint not null) {clustered};
)",
    R"(
create table quarantine (
  id {id}, at bigint not null, table_name text not null, content text not null,
  reason text not null);
create view quarantine_list as
select id, {time at} as at, table_name, content, reason, at as at_ns from quarantine;
)",
    // Epochs of the catalogues of buses (UTC nanoseconds). The samples that a bus published from an
    // epoch until the next one belong to it.
    R"(
create table bus_epochs (
  bus text not null, epoch bigint not null, primary key (bus, epoch)) {clustered};
)",
    // Documents of the station. Each version of a dashboard is a row. A picture is SVG, or PNG in
    // base64; width and height are in its own units.
    R"(
create table dashboards (
  name text not null, version bigint not null, title text not null, content text not null,
  saved_by text not null, saved_at bigint not null, primary key (name, version)) {clustered};
create table pictures (
  name text primary key, version bigint not null, type text not null, width bigint not null,
  height bigint not null, bytes bigint not null, content text not null, saved_by text not null,
  saved_at bigint not null) {clustered};
)",
    // Notifications of a station (notification_table.hpp).
    R"(
create table notify_progress (
  rule text not null, bus text not null, device text not null, channel text not null,
  limit_kind text not null, state smallint not null, occurrence bigint not null,
  first_at bigint not null, last_at bigint not null, count bigint not null,
  escalated bigint not null, returned smallint not null,
  primary key (rule, bus, device, channel, limit_kind)) {clustered};
create table notify_windows (
  rule text not null, target text not null, start bigint not null, count bigint not null,
  lines text not null, more bigint not null, primary key (rule, target)) {clustered};
create table notifications (
  id text primary key, target text not null, recipient text not null, made_at bigint not null,
  subject text not null, content text not null, json text not null, state text not null,
  attempts bigint not null, next_at bigint not null, done_at bigint not null,
  error text not null);
create index notifications_waiting on notifications (target, next_at) where state = 'waiting';
create index notifications_made on notifications (made_at);
)",
    // Reports of a station (tools/station/report). query: of the address of the page. period: the
    // day or the month of the report. The attachment of a mail is base64, empty once it was sent.
    R"(
create table reports (
  name text primary key, query text not null, saved_by text not null,
  saved_at bigint not null) {clustered};
create table report_runs (
  report text not null, via text not null, period text not null, made_at bigint not null,
  result text not null, primary key (report, via, period)) {clustered};
alter table notifications add column attachment_name text not null default '';
alter table notifications add column attachment text not null default '';
)",
    // Samples of a device that arrived late (late_table.hpp). Times are UTC in nanoseconds.
    R"(
create table late_ranges (
  bus text not null, device text not null, start bigint not null, until bigint not null,
  samples bigint not null, received_at bigint not null,
  primary key (bus, device, start)) {clustered};
)",
    // The time by which samples are old (retention.hpp); 0: none yet.
    R"(
create table retention_clock (at bigint not null);
insert into retention_clock values (0);
)",
};

// Text that differs between the two databases, or that several steps repeat.
struct Phrase {
  std::string_view name;
  // `{}` is replaced by the argument, as of `{time s.published_at}`. PostgreSQL: null if the same.
  const char* sqlite;
  const char* postgres;
};
constexpr Phrase kPhrases[] = {
    {"id", "integer primary key", "bigint generated by default as identity primary key"},
    {"clustered", "without rowid", ""},
    // UTC; 0 is never. SQLite has no type for times: text of RFC 3339 with nanoseconds.
    {"time",
     "case when {} > 0 then strftime('%Y-%m-%dT%H:%M:%S', {} / 1000000000, 'unixepoch') || "
     "printf('.%09dZ', {} % 1000000000) end",
     "case when {} > 0 then timestamptz 'epoch' + {} / 1000 * interval '1 microsecond' end"},
    {"quality",
     "case {} when 0 then 'GOOD' when 1 then 'UNCERTAIN' when 2 then 'BAD_NO_ANSWER' when 3 then "
     "'BAD_FRAME' when 4 then 'BAD_DEVICE_ERROR' when 5 then 'BAD_RANGE' when 6 then "
     "'BAD_CONFIGURATION' else 'NOT_YET_READ' end",
     nullptr},
    // A number of any kind; null for a text or NaN.
    {"value",
     "case s.value_kind when 3 then nullif(s.real_value, 'NaN') when 4 then null "
     "else cast(s.integer_value as double precision) + "
     "case when s.value_kind = 2 and s.integer_value < 0 then 18446744073709551616.0 else 0 end "
     "end",
     nullptr},
    {"totals",
     "t.count, t.bad, t.min, t.max, t.sum / nullif(t.count, 0) as average, t.sum, t.first, t.last, "
     "t.start as start_ns",
     nullptr},
    {"last sample",
     "cross join samples s on s.channel = c.id and (s.published_at, s.sequence) = (select "
     "published_at, "
     "sequence from samples where channel = c.id order by published_at desc, sequence desc limit "
     "1)",
     "cross join lateral (select * from samples where channel = c.id order by published_at desc, "
     "sequence desc limit 1) s"},
};

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::string spelled_phrase(std::string_view text, SqlConnection::Dialect dialect) {
  for (const Phrase& phrase : kPhrases) {
    if (!text.starts_with(phrase.name)) continue;
    std::string_view argument = text.substr(phrase.name.size());
    if (!argument.empty()) argument.remove_prefix(1);  // the space before it
    const bool sqlite = dialect == SqlConnection::Dialect::kSqlite || phrase.postgres == nullptr;
    return replaced(sqlite ? phrase.sqlite : phrase.postgres, "{}", std::string(argument));
  }
  FIELDCAST_CHECK(false);
}

std::string spelled(std::string_view step, SqlConnection::Dialect dialect) {
  std::string text;
  for (std::size_t open = 0; (open = step.find('{')) != std::string_view::npos;) {
    const std::size_t close = step.find('}', open);
    text += step.substr(0, open);
    text += spelled_phrase(step.substr(open + 1, close - open - 1), dialect);
    step.remove_prefix(close + 1);
  }
  return text.append(step);
}

std::int64_t version_of(SqlConnection& connection) {
  std::int64_t version = 0;
  connection.query("select version from fieldcast_version", {}, [&](const SqlRow& row) {
    version = integer_at(row, 0);
    return false;
  });
  return version;
}

bool is_present(SqlConnection& connection) {
  const bool sqlite = connection.dialect() == SqlConnection::Dialect::kSqlite;
  std::int64_t tables = 0;
  connection.query(
      sqlite
          ? "select count(*) from sqlite_master where type = 'table' and name = 'fieldcast_version'"
          : "select count(*) from pg_class where oid = to_regclass('fieldcast_version')",
      {}, [&](const SqlRow& row) {
        tables = integer_at(row, 0);
        return true;
      });
  return tables > 0 && version_of(connection) == present_version();
}

}  // namespace

std::int64_t present_version() { return std::size(kSteps); }

void bring_to_present(SqlConnection& connection, const std::string& store_name) {
  if (is_present(connection)) return;  // the usual case, without a lock for readers
  SqlTransaction transaction(connection);
  if (connection.dialect() == SqlConnection::Dialect::kPostgres) {
    // Any number, the same for all programs that do this.
    connection.script("select pg_advisory_xact_lock(7021133)");
  }
  connection.script("create table if not exists fieldcast_version (version bigint not null)");
  const std::int64_t version = version_of(connection);
  if (version > present_version()) {
    throw StoreError(
        fmt::format("store {}: a newer Fieldcast made it (version {}, this one knows {}); use that "
                    "one, or another store",
                    store_name, version, present_version()));
  }
  for (std::int64_t step = version; step < present_version(); ++step) {
    connection.script(spelled(kSteps[step], connection.dialect()));
  }
  if (version < present_version()) {
    connection.script("delete from fieldcast_version");
    connection.execute("insert into fieldcast_version values ($1)", SqlRow{present_version()});
  }
  transaction.commit();
}

}  // namespace fieldcast
