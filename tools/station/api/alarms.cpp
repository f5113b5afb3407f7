#include "tools/station/api/alarms.hpp"

#include "bridge/store/alarm_life_table.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/base/parameters.hpp"
#include "tools/station/api/base/response.hpp"
#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {
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

}  // namespace fieldcast::web
