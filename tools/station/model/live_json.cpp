#include "tools/station/model/live_json.hpp"

#include <utility>

#include "core/base/cause.hpp"
#include "core/base/json.hpp"

namespace fieldcast::web {
namespace {

std::string counts_json(const CauseCounts& counts) {
  JsonObject json;
  for (const auto& [cause, count] : counts) json.add(cause, count);
  return json.take();
}

std::string texts_json(const std::vector<std::string>& texts) {
  return json_array(texts,
                    [](std::string& out, const std::string& text) { append_json_text(out, text); });
}

std::string areas_json(const std::vector<AreaReport>& areas) {
  return json_array(areas, [](std::string& out, const AreaReport& area) {
    out += JsonObject()
               .add("area", area.area)
               .add("answer_time_ms", milliseconds(area.response_time))
               .add("answer_spread_ms", milliseconds(area.response_spread))
               .add("largest_block", area.largest_block)
               .add("longest_block", area.longest_block)
               .take();
  });
}

std::string limits_json(const StationChannel& channel) {
  JsonObject json;
  const auto add = [&json](const char* name, const std::optional<double>& limit) {
    if (limit) json.add(name, *limit);
  };
  add("low-low", channel.limits.low_low);
  add("low", channel.limits.low);
  add("high", channel.limits.high);
  add("high-high", channel.limits.high_high);
  add("write-min", channel.write_min);
  add("write-max", channel.write_max);
  return json.take();
}

void append_row(std::string& out, const LiveChannel& live) {
  const StationChannel& channel = live.channel;
  const auto text = [&out](std::string_view part) {
    out += ',';
    append_json_text(out, part);
  };
  out += '[';
  out += std::to_string(live.id);
  text(channel.path());
  text(channel.type);
  text(channel.unit);
  text(channel.at);
  text(to_text(channel.access));
  text(to_text(channel.mode));
  out += ',';
  append_json_number(out, milliseconds(channel.refresh));
  out += ',';
  out += limits_json(channel);
  text(channel.description);
  text(channel.bridge);
  out += ']';
}

void add_time(JsonObject& json, std::string_view name, Duration period, Duration time) {
  if (period == Duration::zero()) {
    json.add_json(name, "null");
  } else {
    json.add(name, milliseconds(time));
  }
}

void append_point(std::string& out, const PlanReport::Point& point) {
  JsonObject json;
  json.add("area", point.area)
      .add("first", point.first)
      .add("count", point.count)
      .add_json("channels", texts_json(point.channels));
  add_time(json, "period_ms", point.period, point.period);
  add_time(json, "phase_ms", point.period, point.phase);
  add_time(json, "worst_gap_ms", point.worst_gap.value_or(Duration::zero()),
           point.worst_gap.value_or(Duration::zero()));
  out += json.add("stretch", point.stretch).take();
}

void append_group(std::string& out, const PlanReport::Group& group) {
  JsonObject json;
  json.add("device", group.device).add("list", group.list);
  add_time(json, "period_ms", group.period, group.period);
  add_time(json, "phase_ms", group.period, group.phase);
  add_time(json, "slack_ms", group.period, group.slack);
  out += json.add("load", group.load)
             .add_json("points", json_array(group.points, append_point))
             .take();
}

}  // namespace

std::string bus_json(const StationBusStatus& bus) {
  const BusReport& report = bus.report;
  JsonObject json;
  json.add("bus", bus.bus)
      .add("bridge", bus.bridge)
      .add("state", to_text(report.state))
      .add("utilisation", report.utilisation)
      .add("planned_load", report.planned_load)
      .add("measured_load", report.measured_load)
      .add("stretch", report.stretch)
      .add("exchanges", report.exchanges)
      .add("samples", report.samples)
      .add("commands", report.commands)
      .add("deadline_misses", report.deadline_misses)
      .add("bytes_sent", report.bytes_sent)
      .add("bytes_received", report.bytes_received)
      .add("reopened", report.reopened)
      .add("dds_deadline_misses", bus.dds_deadline_misses)
      .add_json("causes", counts_json(bus.causes))
      .add_json("misses", counts_json(bus.misses))
      .add("reported_ms", bus.reported_at);
  if (report.closed_because != Cause::kNone)
    json.add("closed_because", to_name(report.closed_because));
  if (bus.clock_ahead) json.add("clock_ahead_ms", to_seconds(*bus.clock_ahead) * 1e3);
  return json.take();
}

std::string device_json(const StationDeviceStatus& device, const StationDeviceDescription* about) {
  const DeviceReport& report = device.report;
  JsonObject json;
  json.add("bus", device.bus)
      .add("device", device.device)
      .add("state", to_text(report.state))
      .add("exchanges", report.exchanges)
      .add("failures", report.failures)
      .add("retries", report.retries)
      .add("deadline_misses", report.deadline_misses)
      .add("answer_time_ms", milliseconds(report.response_time))
      .add("answer_spread_ms", milliseconds(report.response_spread))
      .add("timeout_ms", milliseconds(report.timeout))
      .add("pause_ms", milliseconds(report.pause))
      .add_json("areas", areas_json(report.areas))
      .add_json("refused", texts_json(report.refused))
      .add_json("refused_gaps", texts_json(report.refused_gaps))
      .add_json("causes", counts_json(device.causes))
      .add("reported_ms", device.reported_at);
  if (about != nullptr)
    json.add("protocol", about->protocol).add("port", about->port).add("address", about->address);
  return json.take();
}

std::string description_json(const StationDeviceDescription& about) {
  JsonObject configured, resolution;
  for (const auto& [channel, shown] : about.digits)
    (shown.configured ? configured : resolution).add(channel, static_cast<unsigned>(shown.digits));
  return JsonObject()
      .add("bus", about.bus)
      .add("device", about.device)
      .add("bridge", about.bridge)
      .add("protocol", about.protocol)
      .add("port", about.port)
      .add("address", about.address)
      .add_json("digits", configured.take())
      .add_json("resolution", resolution.take())
      .take();
}

std::string interest_json(const Interest& interest) {
  return JsonObject()
      .add("station", interest.station)
      .add("pattern", interest.pattern)
      .add("refresh_ms", milliseconds(interest.refresh.value_or(Duration{})))
      .take();
}

std::string alarm_json(const LiveAlarm& alarm) {
  return JsonObject()
      .add("bus", alarm.bus)
      .add("device", alarm.device)
      .add("channel", alarm.channel)
      .add("limit", to_text(alarm.limit))
      .add("priority", alarm.priority)
      .add("state", alarm.state)
      .add("active", alarm.active)
      .add("value", alarm.value)
      .add("since_ms", alarm.since)
      .add("raised_ns", std::to_string(alarm.raised_at.nanoseconds))
      .add("occurrences", alarm.occurrences)
      .add("chattering", alarm.chattering)
      .add("acknowledged_by", alarm.acknowledged_by)
      .add("acknowledged_ms", alarm.acknowledged_at)
      .add("note", alarm.note)
      .add("shelved_until_ms", alarm.shelved_until)
      .add("shelved_by", alarm.shelved_by)
      .add("suppressed", alarm.suppressed)
      .take();
}

std::string session_json(const LiveSession& live) {
  const ProgramSessionReport& session = live.session;
  return JsonObject()
      .add("bus", session.bus)
      .add("device", session.device)
      .add("state", to_text(session.state))
      .add("who", session.who)
      .add("bytes_to_device", session.bytes_to_device)
      .add("bytes_from_device", session.bytes_from_device)
      .add("since_ms", session.since)
      .add("last_request", live.request)
      .add("last_request_ms", live.requested_at)
      .take();
}

std::string bridge_json(const StationBridge& bridge) {
  const std::string buses =
      json_array(bridge.buses, [](std::string& out, const StationBridge::Bus& bus) {
        out += JsonObject()
                   .add("bus", bus.bus)
                   .add("since_ms", bus.since)
                   .add("serving", bus.serving)
                   .take();
      });
  return JsonObject()
      .add("bridge", bridge.bridge)
      .add("host", bridge.host)
      .add("process", bridge.process)
      .add("version", bridge.version)
      .add("standby_group", bridge.standby_group)
      .add("strength", bridge.strength)
      .add("since_ms", bridge.since)
      .add_json("buses", buses)
      .take();
}

std::string site_json(const LiveSite& site) {
  JsonObject json;
  json.add("site", site.site)
      .add("connected", site.connected)
      .add("heard_ms", site.heard_at)
      .add("reported_ms", site.reported_at)
      .add("backlog_records", site.backlog_records)
      .add("backlog_bytes", site.backlog_bytes)
      .add("backlog_since_ms", site.oldest_at)
      .add("samples", site.samples)
      .add("late_samples", site.late_samples)
      .add("lost_samples", site.lost_samples)
      .add("refused_messages", site.refused);
  if (site.reported_at.nanoseconds != 0)
    json.add("clock_ahead_ms", to_seconds(site.clock_ahead) * 1e3);
  return json.take();
}

std::string stream_json(const LiveStream& stream) {
  return JsonObject()
      .add("connected", stream.connected)
      .add("reason", stream.reason)
      .add("commands", stream.commands)
      .take();
}

std::string read_plan_json(const StationReadPlan& plan) {
  const PlanReport& report = plan.plan;
  JsonObject json;
  json.add("bus", plan.bus)
      .add("in_force_since_ms", plan.in_force_since)
      .add("load", report.load)
      .add("stretch", report.stretch);
  add_time(json, "slot_ms", report.slot, report.slot);
  add_time(json, "hyperperiod_ms", report.slot, report.hyperperiod);
  return json.add_json("groups", json_array(report.groups, append_group)).take();
}

std::string channel_json(const LiveChannel& live, const StationDeviceDescription* about) {
  JsonObject json;
  json.add("channel", live.channel.path())
      .add("type", live.channel.type)
      .add("unit", live.channel.unit)
      .add("access", to_text(live.channel.access))
      .add("refresh_ms", milliseconds(live.channel.refresh));
  if (live.last.acquired_at.nanoseconds == 0) {
    json.add_json("value", "null");
  } else {
    json.add_value("value", live.last.value);
  }
  json.add("quality", to_text(live.last.quality))
      .add("acquired_ms", live.last.acquired_at)
      .add("sequence", live.last.sequence);
  if (live.last.device_code != 0) json.add("device_code", live.last.device_code);
  if (about != nullptr) {
    const auto shown = about->digits.find(live.channel.channel);
    if (shown != about->digits.end())
      json.add("digits", static_cast<unsigned>(shown->second.digits));
  }
  return json.take();
}

std::string names_json(std::initializer_list<std::pair<std::string_view, std::string_view>> names) {
  JsonObject json;
  for (const auto& [name, text] : names) json.add(name, text);
  return json.take();
}

std::string kind_message(std::string_view kind, const std::string& object) {
  return json_joined(JsonObject().add("kind", kind).take(), object);
}

std::string catalogue_json(const LiveModel& model, std::uint64_t after) {
  const LiveModel::CatalogueChange change = model.catalogue_since(after);
  const std::string channels =
      json_array(change.changed,
                 [](std::string& out, const LiveChannel* channel) { append_row(out, *channel); });
  const std::string gone =
      json_array(change.gone, [](std::string& out, auto id) { out += std::to_string(id); });
  return JsonObject()
      .add("version", model.catalogue_version())
      .add("full", change.full)
      .add_json("channels", channels)
      .add_json("gone", gone)
      .take();
}

}  // namespace fieldcast::web
