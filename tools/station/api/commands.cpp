#include "tools/station/api/commands.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "core/base/json.hpp"
#include "tools/station/api/alarm_request.hpp"
#include "tools/station/api/base/response.hpp"
#include "tools/station/http/json_body.hpp"

namespace fieldcast::web {
namespace {

HttpResponse refused(unsigned status, const Refusal& refusal) {
  return error_response(status, refusal.error, refusal.hint);
}

HttpResponse accepted(const std::vector<std::uint64_t>& ids) {
  const auto append = [](std::string& out, std::uint64_t id) { out += std::to_string(id); };
  HttpResponse response = json_response(JsonObject()
                                            .add("request_id", ids.front())
                                            .add_json("request_ids", json_array(ids, append))
                                            .take());
  response.status = 202;
  return response;
}

// The body has the form of {"write": ..} on /live.
void write_value(const LiveModel& model, CommandSink& commands, const HttpRequest& request,
                 const Caller& caller, const Reply& reply) {
  if (auto body = body_of(request); !body) return reply(std::move(body.error()));
  const auto parsed = parse_client_message(JsonObject().add_json("write", request.body).take());
  if (!parsed) return reply(refused(400, parsed.error().refusal));
  const auto* write = std::get_if<WriteChannel>(&parsed->what);
  if (write == nullptr)
    return reply(error_response(400, "this is no write", R"({"channel", "value", "verify"})"));
  const ChannelPath& path = write->path;
  const LiveChannel* live = model.find({path.bus, path.device, path.channel});
  if (live == nullptr || live->gone)
    return reply(error_response(404, "no bridge announces this channel",
                                "GET /api/channels lists those that are there"));
  auto value = value_for(live->channel.type, write->value);
  if (!value) return reply(refused(400, value.error()));
  const auto id =
      commands.submit(caller, write_command(path, *std::move(value), write->verify), {});
  reply(id ? accepted({*id}) : refused(503, id.error()));
}

void act_on_alarms(AlarmActionKind kind, CommandSink& commands, const HttpRequest& request,
                   const Caller& caller, const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  auto actions = alarm_actions(kind, *body);
  if (!actions) return reply(std::move(actions.error()));
  std::vector<std::uint64_t> ids;
  for (AlarmAction& action : *actions) {
    const auto id = commands.submit(caller, std::move(action), {});
    // The previous actions are in flight; repeating the request acknowledges twice without effect.
    if (!id) return reply(refused(503, id.error()));
    ids.push_back(*id);
  }
  reply(accepted(ids));
}

void maintain(CommandSink& commands, const HttpRequest& request, const Caller& caller,
              const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  auto action = maintenance_action(*body);
  if (!action) return reply(std::move(action.error()));
  const auto id = commands.submit(caller, *std::move(action), {});
  reply(id ? accepted({*id}) : refused(503, id.error()));
}

void result_of(const CommandSink& commands, const HttpRequest& request, const Caller& caller,
               const Reply& reply) {
  if (auto fault = Parameters(request, {"request_id"}).fault()) return reply(*std::move(fault));
  const std::string text = request.parameter("request_id").value_or("");
  std::uint64_t id = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), id);
  if (text.empty() || read.ec != std::errc{} || read.ptr != text.data() + text.size())
    return reply(error_response(400, "request_id is missing, or no number",
                                "give the request_id that the command got"));
  const auto outcome = commands.find(caller.user, id);
  if (!outcome)
    return reply(error_response(404, "no such request of this user",
                                "what became of a request is known for some minutes"));
  reply(json_response(outcome_json(*outcome)));
}

}  // namespace

void add_command_routes(RouteTable& table, const LiveModel& model, CommandSink& commands) {
  table.add({Method::kPost, "/api/commands", Access::kOperator,
             [&](const HttpRequest& request, const Caller& caller, const Reply& reply) {
               write_value(model, commands, request, caller, reply);
             }});
  table.add({Method::kGet, "/api/commands/result", Access::kOperator,
             [&](const HttpRequest& request, const Caller& caller, const Reply& reply) {
               result_of(commands, request, caller, reply);
             }});
  const std::pair<const char*, AlarmActionKind> kinds[] = {
      {"/api/alarms/acknowledge", AlarmActionKind::kAcknowledge},
      {"/api/alarms/shelve", AlarmActionKind::kShelve},
      {"/api/alarms/unshelve", AlarmActionKind::kUnshelve}};
  for (const auto& [path, kind] : kinds) {
    table.add({Method::kPost, path, Access::kOperator,
               [&commands, kind = kind](const HttpRequest& request, const Caller& caller,
                                        const Reply& reply) {
                 act_on_alarms(kind, commands, request, caller, reply);
               }});
  }
  table.add({Method::kPost, "/api/alarms/maintenance", Access::kOperator,
             [&commands](const HttpRequest& request, const Caller& caller, const Reply& reply) {
               maintain(commands, request, caller, reply);
             }});
}

}  // namespace fieldcast::web
