#include "tools/station/api/api_routes.hpp"

#include <algorithm>
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

// Caches the whole catalogue as compressed JSON.
class KeptCatalogue {
 public:
  [[nodiscard]] std::shared_ptr<const std::string> whole(const LiveModel& model) {
    if (!kept_ || version_ != model.catalogue_version()) {
      version_ = model.catalogue_version();
      kept_ = std::make_shared<const std::string>(packed(catalogue_json(model, 0)));
    }
    return kept_;
  }

 private:
  std::shared_ptr<const std::string> kept_;
  std::uint64_t version_ = 0;
};

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

void catalogue(const LiveModel& model, KeptCatalogue& kept, const HttpRequest& request,
               const Reply& reply) {
  if (auto fault = Parameters(request, {"after"}).fault()) return reply(*std::move(fault));
  auto after = version_of(request);
  if (!after) return reply(std::move(after.error()));
  if (*after != 0 || !request.accepts_gzip)
    return reply(json_response(catalogue_json(model, *after), request.accepts_gzip));
  HttpResponse response;
  response.shared_body = kept.whole(model);
  response.headers.emplace_back("content-encoding", "gzip");
  reply(std::move(response));
}

void channels(const LiveModel& model, const HttpRequest& request, const Reply& reply) {
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
  for (const LiveChannel* live : model.channels()) {
    const StationChannel& channel = live->channel;
    if (!pattern->matches(channel.bus, channel.device, channel.channel)) continue;
    if (after && ChannelPath{channel.bus, channel.device, channel.channel} <= *after) continue;
    if (count++ == *limit) break;
    if (json.size() > 1) json += ',';
    json += channel_json(*live);
  }
  reply(json_response(json + ']', request.accepts_gzip));
}

template <class Kind, class ToJson>
Handler all_of(const LiveModel& model, ToJson to_json) {
  return [&model, to_json](const HttpRequest& request, const Caller&, const Reply& reply) {
    if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
    reply(json_response(
        json_array(model.objects().all<Kind>(),
                   [&](std::string& out, const Kind* object) { out += to_json(*object); }),
        request.accepts_gzip));
  };
}

}  // namespace

void add_channel_routes(RouteTable& table, const LiveModel& model) {
  const auto add = [&table](const char* path, Handler handler) {
    table.add({Method::kGet, path, Access::kViewer, std::move(handler)});
  };
  add("/api/catalogue", [&model, kept = std::make_shared<KeptCatalogue>()](
                            const HttpRequest& request, const Caller&, const Reply& reply) {
    catalogue(model, *kept, request, reply);
  });
  add("/api/channels", [&model](const HttpRequest& request, const Caller&, const Reply& reply) {
    channels(model, request, reply);
  });
  add("/api/buses", all_of<StationBusStatus>(model, bus_json));
  add("/api/devices", all_of<StationDeviceStatus>(model, device_json));
  add("/api/sessions", all_of<ProgramSessionReport>(model, session_json));
  add("/api/bridges", all_of<StationBridge>(model, bridge_json));
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

void present(const LiveModel& model, const HttpRequest& request, const Reply& reply) {
  const auto append = [](std::string& out, const LiveAlarm* alarm) { out += alarm_json(*alarm); };
  reply(json_response(
      JsonObject().add_json("alarms", json_array(model.objects().all<LiveAlarm>(), append)).take(),
      request.accepts_gzip));
}

void history(Database& database, UtcTime now, const HttpRequest& request, const Reply& reply) {
  const Parameters parameters(request, {"from", "to", "limit"});
  auto span = parameters.span(now, kOneDay);
  if (!span) return reply(std::move(span.error()));
  auto limit = parameters.number("limit", 1, kMostEvents, 1000);
  if (!limit) return reply(std::move(limit.error()));
  database.answer(
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

void add_alarm_routes(RouteTable& table, const LiveModel& model, Database* database,
                      std::function<UtcTime()> now) {
  const auto handler = [&model, database, now = std::move(now)](const HttpRequest& request,
                                                                const Caller&, const Reply& reply) {
    if (auto fault = Parameters(request, {"from", "to", "limit"}).fault())
      return reply(*std::move(fault));
    if (request.query.empty()) return present(model, request, reply);
    if (database == nullptr) return reply(no_store());
    history(*database, now(), request, reply);
  };
  table.add({Method::kGet, "/api/alarms", Access::kViewer, handler});
}

void add_plan_routes(RouteTable& table, const LiveModel& model) {
  const auto handler = [&model](const HttpRequest& request, const Caller&, const Reply& reply) {
    if (auto fault = Parameters(request, {"bus"}).fault()) return reply(*std::move(fault));
    const auto bus = request.parameter("bus");
    if (!bus) {
      const auto append = [](std::string& out, const StationReadPlan* plan) {
        out += read_plan_json(*plan);
      };
      return reply(json_response(json_array(model.objects().all<StationReadPlan>(), append),
                                 request.accepts_gzip));
    }
    if (const StationReadPlan* plan = model.objects().read_plan(*bus))
      return reply(json_response(read_plan_json(*plan), request.accepts_gzip));
    reply(error_response(
        404, "no bridge publishes a plan of this bus",
        "GET /api/buses lists the buses; a bridge of an older version publishes none"));
  };
  table.add({Method::kGet, "/api/plan", Access::kViewer, handler});
}

void add_routes(RouteTable& routes, const ApiNeeds& needs) {
  add_alarm_routes(routes, needs.model, needs.database, needs.now);
  add_audit_routes(routes, needs.database, needs.now);
  add_channel_routes(routes, needs.model);
  add_command_routes(routes, needs.model, needs.commands);
  add_export_routes(routes, needs.database, needs.now);
  add_history_routes(routes, needs.database, needs.now);
  add_metrics_routes(routes, needs.database, needs.store, needs.recorder, needs.metrics);
  add_openapi_routes(routes);
  add_plan_routes(routes, needs.model);
  add_user_routes(routes, needs.database);
}

}  // namespace fieldcast::web
