// The resources of /api/configuration: passes requests of engineers to the agent of a bridge
// (bridge/configure), which responds with the body of the response.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "config/keys/documents.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/api/device_templates.hpp"

namespace fieldcast::web {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBridgeBytes = 128;  // of a bridge with its site

HttpResponse response_of(const tl::expected<std::string, StationFault>& replied) {
  if (!replied) {
    if (replied.error() == StationFault::kNoRight)
      return error_response(403, "this station has no right to configurations",
                            "fieldcast secure add engineer NAME makes an identity that has it");
    return error_response(504, to_text(replied.error()),
                          "is the bridge running, and does its file have 'configure: { allow: true "
                          "}' and its identity the right (fieldcast secure renew)?");
  }
  const Json parsed = Json::parse(*replied, nullptr, false);
  const bool is_reply = parsed.is_object() && parsed.contains("status") &&
                        parsed["status"].is_number_unsigned() && parsed.contains("body");
  const unsigned status = is_reply ? parsed["status"].get<unsigned>() : 0;
  if (status < 200 || status > 599)
    return error_response(502, "the bridge sent no valid reply", "is it older than the station?");
  HttpResponse response =
      json_response(parsed["body"].dump(-1, ' ', false, Json::error_handler_t::replace));
  response.status = status;
  return response;
}

void send(const Api& api, const std::string& operation, Json request, const Caller& caller,
          const Reply& reply) {
  const auto bridge = text_in(request, "bridge", kMaxBridgeBytes);
  if (!bridge)
    return reply(error_response(400, "bridge is missing", "GET /api/bridges lists the bridges"));
  request.erase("bridge");
  request["operation"] = operation;
  request["who"] = caller.user;
  const bool sent = api.configurations->send(
      *bridge, request.dump(-1, ' ', false, Json::error_handler_t::replace),
      [reply, bridge = *bridge, operation](const ConfigurationRequests::Replied& replied) {
        HttpResponse response = response_of(replied);
        if (operation == "read" && response.status == 200)
          response.body =
              fmt::format("{{\"bridge\":{},{}", Json(bridge).dump(), response.body.substr(1));
        reply(std::move(response));
      });
  if (!sent) reply(error_response(503, "too many requests wait for bridges", "try again later"));
}

// A body with exactly these members, all of them texts.
void send_body(const Api& api, const char* operation, std::initializer_list<const char*> members,
               const HttpRequest& request, const Caller& caller, const Reply& reply) {
  auto body = body_of(request);
  if (!body) return reply(std::move(body.error()));
  for (const auto& [name, value] : body->items()) {
    const bool is_known =
        std::ranges::any_of(members, [&](const char* member) { return name == member; });
    if (!is_known || !value.is_string())
      return reply(error_response(
          400, fmt::format("'{}' is unknown here, or not a text", printable(name, 80)),
          fmt::format("texts: {}", fmt::join(members, ", "))));
  }
  send(api, operation, *std::move(body), caller, reply);
}

void send_query(const Api& api, const char* operation,
                std::initializer_list<std::string_view> names, const HttpRequest& request,
                const Caller& caller, const Reply& reply) {
  if (auto fault = Parameters(request, names).fault()) return reply(*std::move(fault));
  Json query = Json::object();
  for (const std::string_view name : names)
    query[std::string(name)] = request.parameter(name).value_or("");
  send(api, operation, std::move(query), caller, reply);
}

}  // namespace

void show_configuration(const Api& api, const HttpRequest& request, const Caller& caller,
                        const Reply& reply) {
  send_query(api, "read", {"bridge"}, request, caller, reply);
}

void show_configuration_versions(const Api& api, const HttpRequest& request, const Caller& caller,
                                 const Reply& reply) {
  send_query(api, "versions", {"bridge"}, request, caller, reply);
}

void show_configuration_version(const Api& api, const HttpRequest& request, const Caller& caller,
                                const Reply& reply) {
  send_query(api, "version", {"bridge", "version"}, request, caller, reply);
}

void check_configuration(const Api& api, const HttpRequest& request, const Caller& caller,
                         const Reply& reply) {
  send_body(api, "check", {"bridge", "text"}, request, caller, reply);
}

void deploy_configuration(const Api& api, const HttpRequest& request, const Caller& caller,
                          const Reply& reply) {
  send_body(api, "deploy", {"bridge", "base", "text", "why"}, request, caller, reply);
}

void confirm_configuration(const Api& api, const HttpRequest& request, const Caller& caller,
                           const Reply& reply) {
  send_body(api, "confirm", {"bridge", "version"}, request, caller, reply);
}

void roll_back_configuration(const Api& api, const HttpRequest& request, const Caller& caller,
                             const Reply& reply) {
  send_body(api, "rollback", {"bridge", "version", "why"}, request, caller, reply);
}

void show_configuration_schema(const Api&, const HttpRequest& request, const Caller&,
                               const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  reply(json_response(config::schema_text(), request.accepts_gzip));
}

void show_device_templates(const Api&, const HttpRequest& request, const Caller&,
                           const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  Json list = Json::array();
  for (const DeviceTemplate& each : device_templates())
    list.push_back({{"name", each.name},
                    {"maker", each.maker},
                    {"model", each.model},
                    {"protocol", each.protocol},
                    {"text", each.text}});
  reply(json_response(list.dump(-1, ' ', false, Json::error_handler_t::replace),
                      request.accepts_gzip));
}

}  // namespace fieldcast::web
