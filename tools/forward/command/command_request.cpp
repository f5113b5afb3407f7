#include "tools/forward/command/command_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/json_value.hpp"

namespace fieldcast::forward {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxId = 64;

bool is_word(std::string_view text, std::string_view others) {
  return !text.empty() && text.size() <= kMaxId &&
         std::all_of(text.begin(), text.end(), [others](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  others.find(c) != others.npos;
         });
}

bool may_write(const std::vector<CommandRule>& rules, std::string_view user,
               const ChannelPath& channel) {
  return std::any_of(rules.begin(), rules.end(), [&](const CommandRule& rule) {
    if (rule.user != "*" && rule.user != user) return false;
    return std::any_of(rule.channels.begin(), rule.channels.end(), [&](const Pattern& pattern) {
      return pattern.matches(channel.bus, channel.device, channel.channel);
    });
  });
}

// Empty if all members are known and of the right kind.
std::string fault_of(const Json& json) {
  constexpr std::string_view kMembers[] = {"schema", "id",     "channel",
                                           "value",  "verify", "expires_at"};
  for (const auto& item : json.items()) {
    if (std::find(std::begin(kMembers), std::end(kMembers), item.key()) == std::end(kMembers))
      return fmt::format("member '{}' is unknown", item.key().substr(0, kMaxId));
  }
  if (json.value("schema", Json(1)) != Json(1)) return "schema is not 1";
  if (!json.contains("channel") || !json["channel"].is_string())
    return "\"channel\" is missing: \"BUS/DEVICE/CHANNEL\"";
  if (!json.contains("value")) return "\"value\" is missing";
  if (json.contains("verify") && !json["verify"].is_boolean())
    return "\"verify\" is not true or false";
  if (!json.contains("expires_at") || !json["expires_at"].is_number_integer())
    return "\"expires_at\" is missing: Unix time in nanoseconds";
  return {};
}

std::string life_fault(UtcTime expires_at, UtcTime now) {
  const std::int64_t rest = saturated_difference(expires_at.nanoseconds, now.nanoseconds);
  if (rest <= 0) return "expired";
  if (rest > kMaxCommandLife.count())
    return fmt::format(
        "expires in {:.0f} s; at most {:.0f} s are allowed, by the clock of the site",
        to_seconds(Duration{rest}), to_seconds(kMaxCommandLife));
  return {};
}

}  // namespace

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
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return refuse("not a JSON object");
  if (!json.contains("id") || !json["id"].is_string() ||
      !is_word(json["id"].get_ref<const std::string&>(), "-_."))
    return refuse("\"id\" is missing: 1 to 64 letters, digits, '-', '_', '.'");
  fault.id = json["id"].get<std::string>();
  if (!is_word(user, "-_.@"))
    return refuse("the user's name is not 1 to 64 letters, digits, '-', '_', '.', '@'");
  if (std::string found = fault_of(json); !found.empty()) return refuse(std::move(found));
  CommandRequest request{.user = std::string(user), .id = fault.id};
  auto channel = ChannelPath::parse(json["channel"].get_ref<const std::string&>());
  if (!channel) return refuse("\"channel\": " + channel.error());
  request.channel = *std::move(channel);
  if (!may_write(rules, user, request.channel))
    return refuse(fmt::format("user '{}' has no right to write {} at this site", user,
                              request.channel.text()));
  auto value = value_in(json["value"]);
  if (!value)
    return refuse("\"value\" is not a number, true, false, or a text of at most 256 bytes");
  request.value = *std::move(value);
  request.verify = json.value("verify", false);
  request.expires_at = {json["expires_at"].get<std::int64_t>()};
  if (std::string found = life_fault(request.expires_at, now); !found.empty())
    return refuse(std::move(found));
  return request;
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

}  // namespace fieldcast::forward
