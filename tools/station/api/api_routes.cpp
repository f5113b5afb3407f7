#include "tools/station/api/api_routes.hpp"

#include <charconv>

#include "bridge/http/http_message.hpp"
#include "bridge/store/alarm_life_table.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/api/commands.hpp"
#include "tools/station/api/export.hpp"
#include "tools/station/api/history.hpp"
#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {

namespace {

Checked<std::uint64_t> version_of(const HttpRequest& request) {
  const std::string text = request.parameter("after").value_or("0");
  std::uint64_t version = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), version);
  if (read.ec == std::errc{} && read.ptr == text.data() + text.size() && !text.empty())
    return version;
  return tl::make_unexpected(
      error_response(400, "after: this is no version of the catalogue",
                     "give the version of the last response, or leave it out"));
}

template <class Kind, class ToJson>
void show_all(const Api& api, const HttpRequest& request, const Reply& reply, ToJson to_json) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  reply(json_response(
      json_array(api.model->objects().all<Kind>(),
                 [&](std::string& out, const Kind* object) { out += to_json(*object); }),
      request.accepts_gzip));
}

}  // namespace

void show_catalogue(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {"after"}).fault()) return reply(*std::move(fault));
  auto after = version_of(request);
  if (!after) return reply(std::move(after.error()));
  const LiveModel& model = *api.model;
  if (*after != 0 || !request.accepts_gzip)
    return reply(json_response(catalogue_json(model, *after), request.accepts_gzip));
  KeptCatalogue& kept = *api.catalogue;
  if (!kept.json || kept.version != model.catalogue_version())
    kept = {std::make_shared<const std::string>(packed(catalogue_json(model, 0))),
            model.catalogue_version()};
  HttpResponse response;
  response.shared_body = kept.json;
  response.headers.emplace_back("content-encoding", "gzip");
  reply(std::move(response));
}

void show_channels(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"pattern", "after", "limit"});
  if (auto fault = parameters.fault()) return reply(*std::move(fault));
  auto pattern = parameters.pattern("pattern");
  if (!pattern) return reply(std::move(pattern.error()));
  auto limit = parameters.number("limit", 1, kMaxListed, kMaxListed);
  if (!limit) return reply(std::move(limit.error()));
  std::optional<ChannelPath> after;
  if (const auto text = request.parameter("after")) {
    const auto path = ChannelPath::parse(*text);
    if (!path)
      return reply(
          error_response(400, "after: this is no channel",
                         "give BUS/DEVICE/CHANNEL, the last channel of the previous response"));
    after = *path;
  }
  std::string json = "[";
  std::uint32_t count = 0;
  for (const LiveChannel* live : api.model->channels()) {
    const StationChannel& channel = live->channel;
    if (!pattern->matches(channel.bus, channel.device, channel.channel)) continue;
    if (after && ChannelPath{channel.bus, channel.device, channel.channel} <= *after) continue;
    if (count++ == *limit) break;
    if (json.size() > 1) json += ',';
    json += channel_json(*live, api.model->objects().description(channel.bus, channel.device));
  }
  reply(json_response(json + ']', request.accepts_gzip));
}

void show_buses(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  show_all<StationBusStatus>(api, request, reply, bus_json);
}

void show_devices(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  show_all<StationDeviceStatus>(api, request, reply, [&](const StationDeviceStatus& device) {
    return device_json(device, api.model->objects().description(device.bus, device.device));
  });
}

void show_interests(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  show_all<Interest>(api, request, reply, interest_json);
}

void show_sessions(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  show_all<LiveSession>(api, request, reply, session_json);
}

void show_bridges(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  show_all<StationBridge>(api, request, reply, bridge_json);
}

void show_sites(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  const LiveObjects& objects = api.model->objects();
  const auto append = [](std::string& out, const LiveSite* site) { out += site_json(*site); };
  const auto streams = objects.all<LiveStream>();
  reply(json_response(
      JsonObject()
          .add_json("stream", streams.empty() ? "null" : stream_json(*streams.front()))
          .add_json("sites", json_array(objects.all<LiveSite>(), append))
          .take(),
      request.accepts_gzip));
}

namespace {

constexpr std::uint32_t kMostEvents = 10'000;

std::string event_json(const AlarmLogEntry& entry) {
  JsonObject json;
  json.add("at_ms", entry.at)
      .add("bus", entry.bus)
      .add("device", entry.device)
      .add("channel", entry.channel)
      .add("limit", entry.limit)
      .add("event", entry.event);
  if (entry.value)
    json.add("value", *entry.value);
  else
    json.add_json("value", "null");
  return json.add("who", entry.who).add("note", entry.note).add("until_ms", entry.until).take();
}

void show_present(const LiveModel& model, const HttpRequest& request, const Reply& reply) {
  const auto append = [](std::string& out, const LiveAlarm* alarm) { out += alarm_json(*alarm); };
  reply(json_response(
      JsonObject().add_json("alarms", json_array(model.objects().all<LiveAlarm>(), append)).take(),
      request.accepts_gzip));
}

void show_past(Database& database, UtcTime now, const HttpRequest& request, const Reply& reply) {
  const Parameters parameters(request, {"from", "to", "limit"});
  auto span = parameters.span(now, kOneDay);
  if (!span) return reply(std::move(span.error()));
  auto limit = parameters.number("limit", 1, kMostEvents, 1000);
  if (!limit) return reply(std::move(limit.error()));
  database.respond(
      [span = *span, limit = *limit, compress = request.accepts_gzip](SqlConnection& connection) {
        std::string events = "[";
        AlarmLifeTable(connection)
            .newest_log(span.from, span.to, limit, [&](const AlarmLogEntry& entry) {
              if (events.size() > 1) events += ',';
              events += event_json(entry);
            });
        return json_response(JsonObject().add_json("events", events + ']').take(), compress);
      },
      reply);
}

}  // namespace

void show_alarms(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {"from", "to", "limit"}).fault())
    return reply(*std::move(fault));
  if (request.query.empty()) return show_present(*api.model, request, reply);
  if (api.database == nullptr) return reply(no_store());
  show_past(*api.database, api.now(), request, reply);
}

void show_plan(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {"bus"}).fault()) return reply(*std::move(fault));
  const auto bus = request.parameter("bus");
  if (!bus) return show_all<StationReadPlan>(api, request, reply, read_plan_json);
  if (const StationReadPlan* plan = api.model->objects().read_plan(*bus))
    return reply(json_response(read_plan_json(*plan), request.accepts_gzip));
  reply(error_response(
      404, "no bridge publishes a plan of this bus",
      "GET /api/buses lists the buses; a bridge of an older version publishes none"));
}

void add_routes(RouteTable& routes, Api given) {
  const auto api = std::make_shared<const Api>(std::move(given));
  for (const ApiRow& row : kApiRows)
    routes.add({row.method, row.path, row.access,
                [api, &row](const HttpRequest& request, const Caller& caller, const Reply& reply) {
                  if (row.needs_store && api->database == nullptr) return reply(no_store());
                  row.handler(*api, request, caller, reply);
                },
                row.body_bytes});
}

}  // namespace fieldcast::web
