#include "tools/station/api/commands.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"

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

}  // namespace

void write_value(const Api& api, const HttpRequest& request, const Caller& caller,
                 const Reply& reply) {
  if (auto body = body_of(request); !body) return reply(std::move(body.error()));
  const auto parsed = parse_client_message(JsonObject().add_json("write", request.body).take());
  if (!parsed) return reply(refused(400, parsed.error().refusal));
  const auto* write = std::get_if<WriteChannel>(&parsed->what);
  if (write == nullptr)
    return reply(error_response(400, "this is no write", R"({"channel", "value", "verify"})"));
  const ChannelPath& path = write->path;
  const LiveChannel* live = api.model->find({path.bus, path.device, path.channel});
  if (live == nullptr || live->gone)
    return reply(error_response(404, "no bridge announces this channel",
                                "GET /api/channels lists those that are there"));
  if (live->origin == Origin::kStream && !api.commands->reaches_stream())
    return reply(refused(409, refusal_of_stream(path.bus)));
  auto value = value_for(live->channel.type, write->value);
  if (!value) return reply(refused(400, value.error()));
  const auto id =
      api.commands->submit(caller, write_command(path, *std::move(value), write->verify), {});
  reply(id ? accepted({*id}) : refused(503, id.error()));
}

namespace {

void act_on_alarms(AlarmActionKind kind, const Api& api, const HttpRequest& request,
                   const Caller& caller, const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  auto actions = alarm_actions(kind, *body);
  if (!actions) return reply(std::move(actions.error()));
  for (const AlarmAction& action : *actions) {
    const std::string& bus = action.alarm.bus;
    if (api.model->objects().is_of_stream(bus) && !api.commands->reaches_stream())
      return reply(refused(409, refusal_of_stream(bus)));
  }
  std::vector<std::uint64_t> ids;
  for (AlarmAction& action : *actions) {
    const auto id = api.commands->submit(caller, std::move(action), {});
    // The previous actions are in flight; repeating the request acknowledges twice without effect.
    if (!id) return reply(refused(503, id.error()));
    ids.push_back(*id);
  }
  reply(accepted(ids));
}

}  // namespace

void acknowledge_alarms(const Api& api, const HttpRequest& request, const Caller& caller,
                        const Reply& reply) {
  act_on_alarms(AlarmActionKind::kAcknowledge, api, request, caller, reply);
}

void shelve_alarms(const Api& api, const HttpRequest& request, const Caller& caller,
                   const Reply& reply) {
  act_on_alarms(AlarmActionKind::kShelve, api, request, caller, reply);
}

void unshelve_alarms(const Api& api, const HttpRequest& request, const Caller& caller,
                     const Reply& reply) {
  act_on_alarms(AlarmActionKind::kUnshelve, api, request, caller, reply);
}

namespace {

void act_on_device(Checked<AlarmAction> (*action_in)(const nlohmann::json& body), const Api& api,
                   const HttpRequest& request, const Caller& caller, const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  auto action = action_in(*body);
  if (!action) return reply(std::move(action.error()));
  const std::string& bus = action->alarm.bus;
  if (api.model->objects().is_of_stream(bus))
    return reply(refused(409, refusal_of_device_action(bus)));
  const auto id = api.commands->submit(caller, *std::move(action), {});
  reply(id ? accepted({*id}) : refused(503, id.error()));
}

}  // namespace

void maintain_device(const Api& api, const HttpRequest& request, const Caller& caller,
                     const Reply& reply) {
  act_on_device(maintenance_action, api, request, caller, reply);
}

void end_session(const Api& api, const HttpRequest& request, const Caller& caller,
                 const Reply& reply) {
  act_on_device(end_of_session, api, request, caller, reply);
}

void show_result(const Api& api, const HttpRequest& request, const Caller& caller,
                 const Reply& reply) {
  if (auto fault = Parameters(request, {"request_id"}).fault()) return reply(*std::move(fault));
  const std::string text = request.parameter("request_id").value_or("");
  std::uint64_t id = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), id);
  if (text.empty() || read.ec != std::errc{} || read.ptr != text.data() + text.size())
    return reply(error_response(400, "request_id is missing, or no number",
                                "give the request_id that the command got"));
  const auto outcome = api.commands->find(caller.user, id);
  if (!outcome)
    return reply(error_response(404, "no such request of this user",
                                "what became of a request is known for some minutes"));
  reply(json_response(outcome_json(*outcome)));
}

namespace {

using Body = nlohmann::json;

constexpr std::size_t kMaxNameBytes = 64;   // limit of the topic
constexpr std::size_t kMaxNoteBytes = 256;  // limit of the topic

tl::unexpected<HttpResponse> refuse(std::string_view error, std::string_view hint) {
  return tl::make_unexpected(error_response(400, error, hint));
}

using Names = std::initializer_list<std::pair<const char*, std::string*>>;

std::optional<HttpResponse> read_names(const Body& object, Names names) {
  for (const auto& [name, to] : names) {
    auto text = text_in(object, name, kMaxNameBytes);
    if (!text)
      return error_response(400, fmt::format("{} is missing, or no name", name),
                            fmt::format("\"{}\": a text of 1 to {} bytes", name, kMaxNameBytes));
    *to = *std::move(text);
  }
  return std::nullopt;
}

Checked<std::string> note_in(const Body& object) {
  const auto found = object.find("note");
  if (found == object.end()) return std::string();
  if (found->is_string() && found->get_ref<const std::string&>().size() <= kMaxNoteBytes)
    return printable(found->get<std::string>());
  return refuse("the note cannot be used",
                fmt::format("\"note\": a text of at most {} bytes", kMaxNoteBytes));
}

Checked<Duration> minutes_in(const Body& object, std::uint32_t least, std::uint32_t most) {
  const auto found = object.find("minutes");
  if (found != object.end() && found->is_number_unsigned()) {
    const auto minutes = found->get<std::uint64_t>();
    if (minutes >= least && minutes <= most)
      return std::chrono::minutes{static_cast<std::int64_t>(minutes)};
  }
  return refuse("minutes is missing, or out of range",
                fmt::format("\"minutes\": a whole number from {} to {}", least, most));
}

Checked<UtcTime> raised_in(const Body& object) {
  UtcTime raised;
  const auto found = object.find("raised_ns");
  if (found == object.end()) return raised;
  if (found->is_string()) {
    const auto& text = found->get_ref<const std::string&>();
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, raised.nanoseconds);
    if (read.ec == std::errc{} && read.ptr == end) return raised;
  }
  return refuse("this is no time of an occurrence", R"("raised_ns": the text of the alarm)");
}

Checked<AlarmKey> alarm_in(const Body& object) {
  if (!object.is_object())
    return refuse("an alarm is an object", R"({"bus", "device", "channel", "limit"})");
  if (auto fault = unknown_member(object, {"bus", "device", "channel", "limit", "raised_ns"}))
    return tl::make_unexpected(*std::move(fault));
  AlarmKey key;
  if (auto fault = read_names(
          object, {{"bus", &key.bus}, {"device", &key.device}, {"channel", &key.channel}}))
    return tl::make_unexpected(*std::move(fault));
  const auto limit = text_in(object, "limit", kMaxNameBytes);
  const auto kind = limit ? limit_kind_from(*limit) : std::nullopt;
  if (!kind) return refuse("this is no limit", R"("limit": "low-low", "low", "high", "high-high")");
  key.limit = *kind;
  return key;
}

}  // namespace

Checked<std::vector<AlarmAction>> alarm_actions(AlarmActionKind kind, const Body& body) {
  const bool shelves = kind == AlarmActionKind::kShelve;
  auto fault = shelves ? unknown_member(body, {"alarms", "note", "minutes"})
                       : unknown_member(body, {"alarms", "note"});
  if (fault) return tl::make_unexpected(*std::move(fault));
  AlarmAction action{.kind = kind};
  auto note = note_in(body);
  if (!note) return tl::make_unexpected(std::move(note.error()));
  action.note = *std::move(note);
  if (shelves) {
    const auto minutes = minutes_in(body, 1, kMaxShelvedMinutes);
    if (!minutes) return tl::make_unexpected(minutes.error());
    action.duration = *minutes;
  }
  const auto alarms = body.find("alarms");
  if (alarms == body.end() || !alarms->is_array() || alarms->empty() ||
      alarms->size() > kMaxAlarmsAtOnce)
    return refuse("alarms is missing, empty or too long",
                  fmt::format("\"alarms\": 1 to {} of {{\"bus\", \"device\", \"channel\", "
                              "\"limit\"}}",
                              kMaxAlarmsAtOnce));
  std::vector<AlarmAction> actions;
  for (const Body& each : *alarms) {
    auto key = alarm_in(each);
    if (!key) return tl::make_unexpected(std::move(key.error()));
    action.alarm = *std::move(key);
    const auto raised = raised_in(each);
    if (!raised) return tl::make_unexpected(raised.error());
    if (kind == AlarmActionKind::kAcknowledge) action.raised_at = *raised;
    actions.push_back(action);
  }
  return actions;
}

Checked<AlarmAction> maintenance_action(const Body& body) {
  if (auto fault = unknown_member(body, {"bus", "device", "minutes", "note"}))
    return tl::make_unexpected(*std::move(fault));
  AlarmAction action;
  if (auto fault = read_names(body, {{"bus", &action.alarm.bus}, {"device", &action.alarm.device}}))
    return tl::make_unexpected(*std::move(fault));
  auto note = note_in(body);
  if (!note) return tl::make_unexpected(std::move(note.error()));
  const auto minutes = minutes_in(body, 0, kMaxMaintenanceMinutes);
  if (!minutes) return tl::make_unexpected(minutes.error());
  action.note = *std::move(note);
  action.duration = *minutes;
  action.kind =
      *minutes == Duration{} ? AlarmActionKind::kEndMaintenance : AlarmActionKind::kMaintenance;
  return action;
}

Checked<AlarmAction> end_of_session(const Body& body) {
  if (auto fault = unknown_member(body, {"bus", "device", "note"}))
    return tl::make_unexpected(*std::move(fault));
  AlarmAction action{.kind = AlarmActionKind::kEndSession};
  if (auto fault = read_names(body, {{"bus", &action.alarm.bus}, {"device", &action.alarm.device}}))
    return tl::make_unexpected(*std::move(fault));
  auto note = note_in(body);
  if (!note) return tl::make_unexpected(std::move(note.error()));
  action.note = *std::move(note);
  return action;
}

}  // namespace fieldcast::web
