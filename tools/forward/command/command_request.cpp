#include "tools/forward/command/command_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/json_value.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::forward {

namespace {

using Tree = nlohmann::json;

constexpr std::size_t kMaxId = 64;
constexpr std::size_t kMaxNote = 256;        // bytes
constexpr std::size_t kMaxResponse = 16384;  // the same
constexpr std::uint32_t kMaxMinutes = 1440;

struct ActionRow {
  CentreAction action;
  std::string_view name;
  std::array<std::string_view, 3> members;  // in addition to kMembers
};
constexpr std::array<std::string_view, 5> kMembers{"schema", "id", "action", "channel",
                                                   "expires_at"};
constexpr ActionRow kActions[] = {
    {CentreAction::kWrite, "write", {"value", "verify"}},
    {CentreAction::kAcquire, "acquire", {}},
    {CentreAction::kAcknowledge, "acknowledge", {"limit", "note", "raised_at"}},
    {CentreAction::kShelve, "shelve", {"limit", "note", "minutes"}},
    {CentreAction::kUnshelve, "unshelve", {"limit", "note"}},
};

bool is_word(std::string_view text, std::string_view others) {
  return !text.empty() && text.size() <= kMaxId &&
         std::all_of(text.begin(), text.end(), [others](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  others.find(c) != others.npos;
         });
}

bool may_command(const std::vector<CommandRule>& rules, std::string_view user,
                 const ChannelPath& channel) {
  return std::any_of(rules.begin(), rules.end(), [&](const CommandRule& rule) {
    if (rule.user != "*" && rule.user != user) return false;
    return std::any_of(rule.channels.begin(), rule.channels.end(), [&](const Pattern& pattern) {
      return pattern.matches(channel.bus, channel.device, channel.channel);
    });
  });
}

using Fault = std::string;  // empty: none

Fault read_action(const Tree& json, CommandRequest& request) {
  const Tree action = json.value("action", Tree("write"));
  const auto* const row = std::ranges::find_if(
      kActions, [&](const ActionRow& each) { return action == Tree(each.name); });
  if (row == std::end(kActions))
    return "\"action\" is not write, acquire, acknowledge, shelve or unshelve";
  request.action = row->action;
  for (const auto& item : json.items()) {
    const auto has = [&](const auto& names) {
      return !item.key().empty() && std::ranges::find(names, item.key()) != names.end();
    };
    if (!has(kMembers) && !has(row->members))
      return fmt::format("member '{}' is unknown", item.key().substr(0, kMaxId));
  }
  return {};
}

Fault read_value(const Tree& json, CommandRequest& request) {
  if (!json.contains("value")) return "\"value\" is missing";
  if (json.contains("verify") && !json["verify"].is_boolean())
    return "\"verify\" is not true or false";
  auto value = value_in(json["value"]);
  if (!value) return "\"value\" is not a number, true, false, or a text of at most 256 bytes";
  request.value = *std::move(value);
  request.verify = json.value("verify", false);
  return {};
}

Fault read_alarm(const Tree& json, CommandRequest& request) {
  const Tree limit = json.value("limit", Tree());
  const auto kind =
      limit.is_string() ? limit_kind_from(limit.get_ref<const std::string&>()) : std::nullopt;
  if (!kind) return "\"limit\" is not low-low, low, high or high-high";
  const Tree note = json.value("note", Tree(""));
  if (!note.is_string() || note.get_ref<const std::string&>().size() > kMaxNote)
    return fmt::format("\"note\" is not a text of at most {} bytes", kMaxNote);
  request.limit = *kind;
  request.note = printable(note.get<std::string>());
  const Tree raised = json.value("raised_at", Tree(0));
  if (!raised.is_number_integer()) return "\"raised_at\" is not Unix time in nanoseconds";
  request.raised_at = {raised.get<std::int64_t>()};
  if (request.action != CentreAction::kShelve) return {};
  const Tree minutes = json.value("minutes", Tree());
  if (!minutes.is_number_unsigned() || minutes == Tree(0) || minutes > Tree(kMaxMinutes))
    return fmt::format("\"minutes\" is not a whole number from 1 to {}", kMaxMinutes);
  request.minutes = minutes.get<std::uint32_t>();
  return {};
}

// Reads all members but `id` and `user`.
Fault read_members(const Tree& json, CommandRequest& request) {
  if (json.value("schema", Tree(1)) != Tree(1)) return "schema is not 1";
  if (Fault found = read_action(json, request); !found.empty()) return found;
  if (!json.contains("channel") || !json["channel"].is_string())
    return "\"channel\" is missing: \"BUS/DEVICE/CHANNEL\"";
  auto channel = ChannelPath::parse(json["channel"].get_ref<const std::string&>());
  if (!channel) return "\"channel\": " + channel.error();
  request.channel = *std::move(channel);
  if (!json.contains("expires_at") || !json["expires_at"].is_number_integer())
    return "\"expires_at\" is missing: Unix time in nanoseconds";
  request.expires_at = {json["expires_at"].get<std::int64_t>()};
  if (request.action == CentreAction::kWrite) return read_value(json, request);
  return alarm_action_of(request.action) ? read_alarm(json, request) : Fault();
}

Fault life_fault(UtcTime expires_at, UtcTime now) {
  const std::int64_t rest = saturated_difference(expires_at.nanoseconds, now.nanoseconds);
  if (rest <= 0) return "expired";
  if (rest > kMaxCommandLife.count())
    return fmt::format(
        "expires in {:.0f} s; at most {:.0f} s are allowed, by the clock of the site",
        to_seconds(Duration{rest}), to_seconds(kMaxCommandLife));
  return {};
}

}  // namespace

std::string_view to_text(CentreAction action) {
  return std::ranges::find(kActions, action, &ActionRow::action)->name;
}

std::optional<AlarmActionKind> alarm_action_of(CentreAction action) {
  switch (action) {
    case CentreAction::kAcknowledge: return AlarmActionKind::kAcknowledge;
    case CentreAction::kShelve: return AlarmActionKind::kShelve;
    case CentreAction::kUnshelve: return AlarmActionKind::kUnshelve;
    case CentreAction::kWrite:
    case CentreAction::kAcquire: break;
  }
  return std::nullopt;
}

tl::expected<CommandRequest, CommandFault> command_request_from(
    std::string_view text, std::string_view user, const std::vector<CommandRule>& rules,
    UtcTime now) {
  CommandFault fault;
  const auto refuse = [&fault](std::string reason) {
    fault.reason = std::move(reason);
    return tl::make_unexpected(fault);
  };
  if (text.size() > kMaxCommandBytes)
    return refuse(fmt::format("{} bytes; at most {} are allowed", text.size(), kMaxCommandBytes));
  const Tree json = Tree::parse(text, nullptr, false);
  if (!json.is_object()) return refuse("not a JSON object");
  if (!json.contains("id") || !json["id"].is_string() ||
      !is_word(json["id"].get_ref<const std::string&>(), "-_."))
    return refuse("\"id\" is missing: 1 to 64 letters, digits, '-', '_', '.'");
  fault.id = json["id"].get<std::string>();
  if (!is_word(user, "-_.@"))
    return refuse("the user's name is not 1 to 64 letters, digits, '-', '_', '.', '@'");
  CommandRequest request{.user = std::string(user), .id = fault.id};
  if (Fault found = read_members(json, request); !found.empty()) return refuse(std::move(found));
  if (!may_command(rules, user, request.channel))
    return refuse(fmt::format("user '{}' has no right to {} {} at this site", user,
                              to_text(request.action), request.channel.text()));
  if (Fault found = life_fault(request.expires_at, now); !found.empty())
    return refuse(std::move(found));
  return request;
}

std::string to_json(const CommandRequest& request) {
  Json json{{"schema", 1},
            {"id", request.id},
            {"action", to_text(request.action)},
            {"channel", request.channel.text()},
            {"expires_at", request.expires_at.nanoseconds}};
  if (request.action == CentreAction::kWrite)
    json.add("value", Json(request.value)).add("verify", request.verify);
  if (alarm_action_of(request.action))
    json.add("limit", to_text(request.limit)).add("note", request.note);
  if (request.raised_at.nanoseconds != 0) json.add("raised_at", request.raised_at.nanoseconds);
  if (request.action == CentreAction::kShelve) json.add("minutes", request.minutes);
  return json.text();
}

CommandTimes times_within(Duration lifespan) {
  constexpr Duration kFinding = std::chrono::seconds{2};
  const Duration finding = std::min(kFinding, lifespan / 2), left = lifespan - finding;
  const Duration seconds = std::chrono::floor<std::chrono::seconds>(left);
  return {finding, seconds > Duration{} ? seconds : left};
}

CommandResponse refusal(std::string id, std::string reason) {
  const bool is_expired = reason == "expired";
  return {.id = std::move(id),
          .state = is_expired ? "expired" : "rejected",
          .cause = "NONE",
          .reason = std::move(reason)};
}

std::string to_json(const CommandResponse& response) {
  std::string values = "[";
  for (const Value& value : response.values) {
    if (values.size() > 1) values += ',';
    append_json_value(values, value);
  }
  JsonObject json;
  json.add("schema", 1).add("id", response.id).add("state", response.state);
  json.add("cause", response.cause).add("reason", response.reason);
  json.add_json("values", values + "]").add("completed_at", response.completed_at.nanoseconds);
  return json.take();
}

std::optional<CommandResponse> command_response_from(std::string_view text) {
  if (text.size() > kMaxResponse) return std::nullopt;
  const Tree json = Tree::parse(text, nullptr, false);
  if (!json.is_object() || json.value("schema", Tree()) != Tree(1)) return std::nullopt;
  CommandResponse response;
  for (const auto& [name, to] :
       {std::pair{"id", &response.id}, std::pair{"state", &response.state},
        std::pair{"cause", &response.cause}, std::pair{"reason", &response.reason}}) {
    const Tree member = json.value(name, Tree());
    if (!member.is_string()) return std::nullopt;
    *to = printable(member.get<std::string>());
  }
  const Tree values = json.value("values", Tree::array());
  if (!values.is_array()) return std::nullopt;
  for (const Tree& each : values) {
    auto value = value_in(each);
    if (!value) return std::nullopt;
    response.values.push_back(*std::move(value));
  }
  const Tree completed = json.value("completed_at", Tree());
  if (!completed.is_number_integer()) return std::nullopt;
  response.completed_at = {completed.get<std::int64_t>()};
  return response;
}

}  // namespace fieldcast::forward
