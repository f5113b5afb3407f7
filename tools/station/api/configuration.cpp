// The resources of /api/configuration: passes requests of engineers to the agent of a bridge
// (bridge/configure), which responds with the body of the response.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "config/keys/documents.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/api/device_templates.hpp"

namespace fieldcast::web {

namespace {

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
  const auto parsed = nlohmann::json::parse(*replied, nullptr, false);
  const bool is_reply = parsed.is_object() && parsed.contains("status") &&
                        parsed["status"].is_number_unsigned() && parsed.contains("body") &&
                        parsed["body"].is_string();
  const unsigned status = is_reply ? parsed["status"].get<unsigned>() : 0;
  std::string body = is_reply ? parsed["body"].get<std::string>() : std::string{};
  if (status < 200 || status > 599 || !nlohmann::json::accept(body))
    return error_response(502, "the bridge sent no valid reply", "is it older than the station?");
  HttpResponse response = json_response(std::move(body));
  response.status = status;
  return response;
}

HttpResponse too_many_requests() {
  return error_response(503, "too many requests wait for bridges; this request was not sent",
                        "try again later");
}

using Texts = std::map<std::string, std::string>;

// `members` of the request, with the bridge.
void send(const Api& api, const std::string& operation, Texts members, const Caller& caller,
          const Reply& reply) {
  const std::string bridge = members["bridge"];
  if (bridge.empty() || bridge.size() > kMaxBridgeBytes)
    return reply(error_response(400, "bridge is missing", "GET /api/bridges lists the bridges"));
  members.erase("bridge");
  members["operation"] = operation;
  members["who"] = caller.user;
  const bool sent = api.configurations->send(
      bridge, Json(members).text(),
      [reply, bridge, operation](const std::optional<ConfigurationRequests::Replied>& replied) {
        HttpResponse response = replied ? response_of(*replied) : too_many_requests();
        if (operation == "read" && response.body.starts_with('{') && response.status == 200)
          response.body = json_joined(JsonObject().add("bridge", bridge).take(), response.body);
        if (operation == "scan" && response.status == 200)
          response.body = with_templates(response.body, device_templates());
        reply(std::move(response));
      });
  if (!sent) reply(too_many_requests());
}

// A body with exactly these members, all of them texts.
void send_body(const Api& api, const char* operation,
               std::initializer_list<std::string_view> members, const HttpRequest& request,
               const Caller& caller, const Reply& reply) {
  auto body = body_of(request);
  if (!body) return reply(std::move(body.error()));
  Texts given;
  for (const auto& [name, value] : body->items()) {
    const bool is_known = std::ranges::find(members, std::string_view(name)) != members.end();
    if (!is_known || !value.is_string())
      return reply(error_response(
          400, fmt::format("'{}' is unknown here, or not a text", printable(name, 80)),
          fmt::format("texts: {}", fmt::join(members, ", "))));
    given[name] = value.get<std::string>();
  }
  send(api, operation, std::move(given), caller, reply);
}

void send_query(const Api& api, const char* operation,
                std::initializer_list<std::string_view> names, const HttpRequest& request,
                const Caller& caller, const Reply& reply) {
  if (auto fault = Parameters(request, names).fault()) return reply(*std::move(fault));
  Texts query;
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

void probe_device(const Api& api, const HttpRequest& request, const Caller& caller,
                  const Reply& reply) {
  send_body(api, "probe", {"bridge", "bus", "device", "text"}, request, caller, reply);
}

void scan_bus(const Api& api, const HttpRequest& request, const Caller& caller,
              const Reply& reply) {
  send_body(api, "scan", {"bridge", "bus", "protocol", "first", "last"}, request, caller, reply);
}

void show_configuration_schema(const Api&, const HttpRequest& request, const Caller&,
                               const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  reply(json_response(config::schema_text(), request.accepts_gzip));
}

void show_device_templates(const Api&, const HttpRequest& request, const Caller&,
                           const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  reply(json_response(
      json_array(device_templates(),
                 [](std::string& out, const DeviceTemplate& each) {
                   out +=
                       JsonObject()
                           .add("name", each.head.name)
                           .add("maker", each.maker)
                           .add("model", each.model)
                           .add("protocol", fmt::format("{}", fmt::join(each.head.protocols, ", ")))
                           .add("text", each.text)
                           .take();
                 }),
      request.accepts_gzip));
}

}  // namespace fieldcast::web
