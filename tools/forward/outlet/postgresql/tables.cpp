#include "tools/forward/outlet/postgresql/tables.hpp"

#include <string_view>

namespace fieldcast::forward {

namespace {

// {s}: the quoted schema.
constexpr std::string_view kTables = R"(
select pg_advisory_xact_lock(hashtext('fieldcast-forward'));
create schema if not exists {s};
do $do$ begin
  if to_regtype('{s}.quality') is null then
    create type {s}.quality as enum ('GOOD', 'UNCERTAIN', 'BAD_NO_ANSWER', 'BAD_FRAME',
      'BAD_DEVICE_ERROR', 'BAD_RANGE', 'BAD_CONFIGURATION', 'NOT_YET_READ');
  end if;
end $do$;
create table if not exists {s}.sites (
  id integer generated always as identity primary key, site text not null unique);
create table if not exists {s}.channels (
  id bigint generated always as identity primary key, site integer not null references {s}.sites,
  bus text not null, device text not null, channel text not null, type text not null,
  unit text not null, at text not null, description text not null, low_low double precision,
  low double precision, high double precision, high_high double precision,
  unique (site, bus, device, channel));
do $do$ begin
  if to_regclass('{s}.samples') is not null then return; end if;
  create table {s}.samples (
    channel bigint not null, epoch bigint not null, sequence bigint not null,
    acquired_at timestamptz not null, quality {s}.quality not null, device_code integer not null,
    value double precision, text text);
  if exists (select from pg_extension where extname = 'timescaledb') then
    alter table {s}.samples add primary key (channel, epoch, sequence, acquired_at);
    perform create_hypertable('{s}.samples', 'acquired_at');
  else
    alter table {s}.samples add primary key (channel, epoch, sequence);
  end if;
  create index samples_time on {s}.samples (channel, acquired_at);
end $do$;
create table if not exists {s}.alarms (
  id bigint generated always as identity, site integer not null references {s}.sites,
  identity bigint not null, bus text not null, device text not null, channel text not null,
  limit_kind text not null, priority text not null, stage text not null, active boolean not null,
  value double precision not null, raised_at timestamptz, cleared_at timestamptz,
  acknowledged_by text not null, acknowledged_note text not null,
  primary key (site, bus, device, channel, limit_kind, identity));
create table if not exists {s}.audit (
  site integer not null references {s}.sites, bridge text not null, epoch bigint not null,
  number bigint not null, at timestamptz not null, who text not null, what text not null,
  target text not null,
  bytes_to_device bigint not null, bytes_from_device bigint not null, result text not null,
  primary key (site, bridge, epoch, number));
create or replace view {s}.sample_history as
select t.site, c.bus, c.device, c.channel, c.unit, c.type, s.acquired_at, s.epoch, s.sequence,
  s.quality::text as quality, s.device_code, s.value, s.text
from {s}.samples s join {s}.channels c on c.id = s.channel join {s}.sites t on t.id = c.site;
create or replace view {s}.alarm_state as
select distinct on (a.site, a.bus, a.device, a.channel, a.limit_kind)
  t.site, a.bus, a.device, a.channel, a.limit_kind, a.priority, a.stage, a.active, a.value,
  a.raised_at, a.cleared_at, a.acknowledged_by, a.acknowledged_note
from {s}.alarms a join {s}.sites t on t.id = a.site
order by a.site, a.bus, a.device, a.channel, a.limit_kind, a.id desc;
)";

constexpr std::string_view kInsertChannels = R"(
with site as (
  insert into {s}.sites (site) values ($1)
  on conflict (site) do update set site = excluded.site returning id)
insert into {s}.channels as c
  (site, bus, device, channel, type, unit, at, description, low_low, low, high, high_high)
select site.id, u.* from site,
  unnest($2::text[], $3::text[], $4::text[], $5::text[], $6::text[], $7::text[], $8::text[],
    $9::double precision[], $10::double precision[], $11::double precision[],
    $12::double precision[]) as u
on conflict (site, bus, device, channel) do )";

constexpr std::string_view kUpdateChannels = R"(update set
  type = excluded.type, unit = excluded.unit, at = excluded.at, description = excluded.description,
  low_low = excluded.low_low, low = excluded.low, high = excluded.high,
  high_high = excluded.high_high
where (c.type, c.unit, c.at, c.description, c.low_low, c.low, c.high, c.high_high) is distinct from
  (excluded.type, excluded.unit, excluded.at, excluded.description, excluded.low_low, excluded.low,
   excluded.high, excluded.high_high))";

constexpr std::string_view kSelectChannels = R"(
select c.channel, c.id from {s}.channels c join {s}.sites t on t.id = c.site
where t.site = $1::text and c.bus = $2::text and c.device = $3::text)";

// timestamptz has microseconds.
constexpr std::string_view kInsertSamples = R"(
insert into {s}.samples (channel, epoch, sequence, acquired_at, quality, device_code, value, text)
select u.c, u.e, u.n, timestamptz 'epoch' + (u.t / 1000) * interval '1 microsecond',
  u.q::{s}.quality, u.d, u.v, u.x
from unnest($1::bigint[], $2::bigint[], $3::bigint[], $4::bigint[], $5::text[], $6::integer[],
  $7::double precision[], $8::text[]) as u (c, e, n, t, q, d, v, x)
on conflict do nothing)";

constexpr std::string_view kInsertAlarm = R"(
with site as (
  insert into {s}.sites (site) values ($1)
  on conflict (site) do update set site = excluded.site returning id)
insert into {s}.alarms (site, identity, bus, device, channel, limit_kind, priority, stage, active,
  value, raised_at, cleared_at, acknowledged_by, acknowledged_note)
select site.id, $2::bigint, $3::text, $4::text, $5::text, $6::text, $7::text, $8::text,
  $9::boolean, $10::double precision,
  timestamptz 'epoch' + (nullif($11::bigint, 0) / 1000) * interval '1 microsecond',
  timestamptz 'epoch' + (nullif($12::bigint, 0) / 1000) * interval '1 microsecond',
  $13::text, $14::text from site
on conflict do nothing)";

constexpr std::string_view kInsertAudit = R"(
with site as (
  insert into {s}.sites (site) values ($1)
  on conflict (site) do update set site = excluded.site returning id)
insert into {s}.audit
select site.id, $2::text, $3::bigint, $4::bigint,
  timestamptz 'epoch' + ($5::bigint / 1000) * interval '1 microsecond',
  $6::text, $7::text, $8::text, $9::bigint, $10::bigint, $11::text from site
on conflict do nothing)";

std::string with_schema(std::string_view text, const std::string& schema) {
  constexpr std::string_view kMark = "{s}";
  std::string filled;
  for (std::size_t at = text.find(kMark); at != text.npos; at = text.find(kMark)) {
    filled.append(text.substr(0, at)).append("\"" + schema + "\"");
    text.remove_prefix(at + kMark.size());
  }
  return filled.append(text);
}

}  // namespace

std::string create_tables(const std::string& schema) { return with_schema(kTables, schema); }
std::string upsert_channels(const std::string& schema) {
  return with_schema(std::string(kInsertChannels).append(kUpdateChannels), schema);
}
std::string insert_channels(const std::string& schema) {
  return with_schema(std::string(kInsertChannels).append("nothing"), schema);
}
std::string select_channels(const std::string& schema) {
  return with_schema(kSelectChannels, schema);
}
std::string insert_samples(const std::string& schema) {
  return with_schema(kInsertSamples, schema);
}
std::string insert_alarm(const std::string& schema) { return with_schema(kInsertAlarm, schema); }
std::string insert_audit(const std::string& schema) { return with_schema(kInsertAudit, schema); }

}  // namespace fieldcast::forward
