#include "tools/station/live/client_message.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/json_value.hpp"
#include "core/base/message_text.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast::web {

namespace {

using Json = nlohmann::json;
using Parsed = tl::expected<ClientMessage, Refusal>;

constexpr std::size_t kShown = 80;  // bytes of client text quoted in an error

tl::unexpected<Refusal> refuse(std::string error, std::string hint) {
  return tl::unexpected(Refusal{std::move(error), std::move(hint)});
}

// Ignores brackets in strings.
bool is_shallow(std::string_view text) {
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxDepth) return false;
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return true;
}

std::optional<std::uint64_t> number_in(const Json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto number = found->get<std::uint64_t>();
  return number <= kMaxExact ? std::optional(number) : std::nullopt;
}

bool has_only(const Json& json, std::initializer_list<std::string_view> names) {
  return std::all_of(json.items().begin(), json.items().end(), [&](const auto& item) {
    return std::find(names.begin(), names.end(), item.key()) != names.end();
  });
}

tl::expected<Pattern, Refusal> pattern_in(const Json& json) {
  if (!json.is_string()) return refuse("a pattern is a text", "write \"bus/device/channel\"");
  const auto& text = json.get_ref<const std::string&>();
  auto pattern = Pattern::parse(text);
  if (text.size() > 3 * 64 + 2 || !pattern)
    return refuse("'" + printable(text, kShown) + "' is no pattern",
                  "write bus/device/channel; * stands for any characters");
  return *pattern;
}

tl::expected<ChannelPath, Refusal> path_in(const Json& json) {
  const auto found = json.find("channel");
  if (found == json.end() || !found->is_string())
    return refuse("the channel is missing", "\"channel\": \"bus/device/channel\"");
  const auto& text = found->get_ref<const std::string&>();
  auto path = ChannelPath::parse(text);
  if (!path)
    return refuse("'" + printable(text, kShown) + "' is no channel", "write bus/device/channel");
  return std::move(*path);
}

tl::expected<Value, Refusal> value_of(const Json& json) {
  const auto found = json.find("value");
  if (found == json.end()) return refuse("the value is missing", "\"value\": 21.5");
  if (auto value = value_in(*found)) return *std::move(value);
  return refuse("this is no value of a channel",
                "a number, true, false, or a text of at most 256 bytes");
}

bool names_one_device(const Pattern& pattern) {
  const std::string text = pattern.text();
  return text.substr(0, text.rfind('/')).find('*') == std::string::npos;
}

Parsed parse_subscribe(const Json& json) {
  if (!has_only(json, {"subscribe", "refresh_ms", "id"}))
    return refuse("a subscription has no such member", "subscribe, refresh_ms, id");
  auto pattern = pattern_in(json["subscribe"]);
  if (!pattern) return tl::unexpected(pattern.error());
  Subscribe wanted{std::move(*pattern), std::nullopt};
  if (const auto refresh = json.find("refresh_ms"); refresh != json.end()) {
    const double ms = refresh->is_number() ? refresh->get<double>() : 0;
    if (!(ms >= milliseconds(kShortestRefresh) && ms <= milliseconds(kLongestRefresh)))
      return refuse("refresh_ms is out of range", "50 to 3600000 ms");
    if (!names_one_device(wanted.pattern))
      return refuse("a refresh is for the channels of one device",
                    "write bus/device/channel or bus/device, without * in bus and device");
    wanted.refresh = from_seconds(ms / 1e3);
  }
  return ClientMessage{{}, std::move(wanted)};
}

Parsed parse_unsubscribe(const Json& json) {
  auto pattern = pattern_in(json["unsubscribe"]);
  if (!pattern) return tl::unexpected(pattern.error());
  return ClientMessage{{}, Unsubscribe{std::move(*pattern)}};
}

Parsed parse_write(const Json& json) {
  const Json& about = json["write"];
  if (!about.is_object() || !has_only(about, {"channel", "value", "verify"}))
    return refuse("a write has channel, value and verify",
                  R"({"write": {"channel": "bus/device/channel", "value": 21.5}, "id": 1})");
  auto path = path_in(about);
  if (!path) return tl::unexpected(path.error());
  auto value = value_of(about);
  if (!value) return tl::unexpected(value.error());
  const auto verify = about.find("verify");
  if (verify != about.end() && !verify->is_boolean())
    return refuse("verify is true or false", "\"verify\": true");
  return ClientMessage{{},
                       WriteChannel{std::move(*path), std::move(*value),
                                    verify != about.end() && verify->get<bool>()}};
}

Parsed parse_acquire(const Json& json) {
  const Json& about = json["acquire"];
  if (!about.is_object() || !has_only(about, {"channel"}))
    return refuse("an acquire has a channel",
                  R"({"acquire": {"channel": "bus/device/channel"}, "id": 1})");
  auto path = path_in(about);
  if (!path) return tl::unexpected(path.error());
  return ClientMessage{{}, AcquireChannel{std::move(*path)}};
}

Parsed parse_ping(const Json&) { return ClientMessage{{}, Ping{}}; }

struct Kind {
  const char* name;
  Parsed (*parse)(const Json&);
};
constexpr std::array kKinds{Kind{"subscribe", parse_subscribe},
                            Kind{"unsubscribe", parse_unsubscribe}, Kind{"write", parse_write},
                            Kind{"acquire", parse_acquire}, Kind{"ping", parse_ping}};

}  // namespace

Refusal refusal_of_stream(std::string_view bus) {
  const std::string site = printable(bus.substr(0, bus.find(':')), kShown);
  return {"site " + site + " is read from the stream, and this station sends no commands by it",
          "write at the site, or set 'stream: { commands: true }' at this station and 'commands' "
          "at the forwarder of the site"};
}

Refusal refusal_of_device_action(std::string_view bus) {
  const std::string site = printable(bus.substr(0, bus.find(':')), kShown);
  return {"site " + site + " is read from the stream, which carries no actions on devices",
          "do this at the site"};
}

ParsedMessage parse_client_message(std::string_view text) {
  const auto fault = [](std::optional<std::uint64_t> id, Refusal refusal) {
    return tl::unexpected(MessageFault{id, std::move(refusal)});
  };
  if (text.size() > kMaxMessage || !is_shallow(text))
    return fault({}, {"the message is too long or too deep", "at most 4096 bytes, 4 levels"});
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object())
    return fault({}, {"the message is no JSON object", R"({"subscribe": "*"})"});
  auto id = number_in(json, "id");
  for (const Kind& kind : kKinds) {
    if (!json.contains(kind.name)) continue;
    Parsed parsed = kind.parse(json);
    if (!parsed) return fault(id, std::move(parsed.error()));
    if (std::holds_alternative<Ping>(parsed->what)) id = number_in(json, "ping");
    parsed->id = id;
    return std::move(*parsed);
  }
  return fault(id, {"the message says nothing that is known",
                    "subscribe, unsubscribe, write, acquire or ping"});
}

tl::expected<Value, Refusal> value_for(std::string_view channel_type, Value value) {
  const auto type = value_type_from(channel_type.substr(0, channel_type.find('(')));
  const std::string* const text = std::get_if<std::string>(&value);
  const std::string wanted = "the channel's type is " + printable(channel_type, 16);
  if (type == ValueType::kString) {
    if (text == nullptr) return refuse("this is no text", wanted);
    return value;
  }
  if (type == ValueType::kBool) {
    if (const auto* number = std::get_if<std::int64_t>(&value);
        number != nullptr && (*number == 0 || *number == 1))
      return *number == 1;
  }
  if (text == nullptr || !type) return value;
  const auto kinds = type == ValueType::kBool
                         ? std::vector{ValueType::kBool}
                         : std::vector{ValueType::kInt64, ValueType::kUint64, ValueType::kFloat64};
  for (const ValueType kind : kinds) {
    if (auto parsed = parse_value(Encoding{kind}, *text)) return std::move(*parsed);
  }
  return refuse("'" + printable(*text, kShown) + "' is no such value", wanted);
}

std::string outcome_json(const CommandOutcome& outcome) {
  JsonObject json;
  json.add("request_id", outcome.request_id)
      .add("target", outcome.target)
      .add("state", outcome.state)
      .add("cause", outcome.cause)
      .add("reason", outcome.reason);
  if (outcome.values.empty()) {
    json.add_json("value", "null");
  } else {
    json.add_value("value", outcome.values.front());
  }
  if (outcome.values.size() > 1)
    json.add_json("values", json_array(outcome.values, [](std::string& out, const Value& value) {
                    append_json_value(out, value);
                  }));
  return json.add("completed_ms", outcome.completed_at).take();
}

StationCommand write_command(const ChannelPath& path, Value value, bool verify) {
  StationCommand command = acquire_command(path);
  command.command.operation = Operation::kWrite;
  command.command.values = {std::move(value)};
  command.command.verify = verify;
  return command;
}

StationCommand acquire_command(const ChannelPath& path) {
  StationCommand command;
  command.bus = path.bus;
  command.command.device = path.device;
  command.command.target = ChannelTarget{path.channel};
  command.command.operation = Operation::kAcquire;
  return command;
}

}  // namespace fieldcast::web
