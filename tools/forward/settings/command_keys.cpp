#include "tools/forward/settings/command_keys.hpp"

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::forward {
namespace {

using config::MapReader;
using config::Node;
using config::Rows;

constexpr std::size_t kMostRules = 1'000, kMostPatterns = 1'000;
constexpr const char* kRuleForm = "{ user: NAME, channels: [BUS/DEVICE/CHANNEL] }";
constexpr const char* kPatternForm = "BUS/DEVICE/CHANNEL, with * for any characters";

const Rows<CommandSpec>& command_rows() {
  static const Rows<CommandSpec> rows(
      "commands", "'commands'",
      {config::field<CommandSpec>(
           {.name = "user",
            .fallback = "needed with `sparkplug`",
            .text = "only with `sparkplug`: the user of every command, because MQTT names none; "
                    "every client that may publish to the topics of DCMD writes as this user"},
           &CommandSpec::user, config::TextRule{64}),
       {{.name = "allow",
         .fallback = std::string(config::kNeeded),
         .text = "a list of rules; a command needs one that allows it",
         .schema = "{}"}}});
  return rows;
}

const Rows<CommandRule>& rule_rows() {
  static const Rows<CommandRule> rows(
      "rule", "a rule",
      {
          config::field<CommandRule>({.name = "user",
                                      .fallback = std::string(config::kNeeded),
                                      .text = "the last token of the subject, or `\"*\"` for every "
                                              "user; the permissions of NATS must allow this "
                                              "subject only to this user"},
                                     &CommandRule::user, config::TextRule{64}),
          {{.name = "channels",
            .fallback = std::string(config::kNeeded),
            .text = "a list of patterns: `BUS/DEVICE/CHANNEL`, with `*` for any characters",
            .schema = "{}"}},
      });
  return rows;
}

void read_channels(MapReader& map, CommandRule& rule) {
  const Node* node = map.require("channels", "channels: [BUS/DEVICE/CHANNEL]");
  if (node == nullptr || !config::is_list(*node, "channels", 1, kMostPatterns, kPatternForm,
                                          map.faults(), config::as_list(*node)))
    return;
  for (const Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, "channel", kPatternForm, map.faults());
    if (text == nullptr) continue;
    if (auto pattern = Pattern::parse(*text)) {
      rule.channels.push_back(*std::move(pattern));
    } else {
      map.faults().add(item->position, pattern.error(), kPatternForm);
    }
  }
}

}  // namespace

std::optional<CommandSpec> read_commands(MapReader& file, const OutletSpec& outlet) {
  const Node* section = file.find("commands");
  if (section == nullptr) return std::nullopt;
  CommandSpec spec;
  const bool is_sparkplug = std::holds_alternative<SparkplugSpec>(outlet);
  if (!is_sparkplug && !std::holds_alternative<JetStreamSpec>(outlet))
    file.fault("commands", "this engine does not carry commands",
               "'commands' beside 'jetstream' or 'sparkplug'");
  MapReader map(*section, command_rows(), file.faults());
  command_rows().read(map, spec);
  if (is_sparkplug) (void)map.require("user", "user: NAME");
  if (!is_sparkplug && !spec.user.empty())
    map.fault("user", "a user, although NATS names the user of each command", "no key 'user'");
  const Node* rules = map.require("allow", "allow: [" + std::string(kRuleForm) + "]");
  if (rules == nullptr ||
      !config::is_list(*rules, "allow", 1, kMostRules, kRuleForm, file.faults()))
    return spec;
  for (const Node* item : rules->items) {
    MapReader each(*item, rule_rows(), file.faults());
    CommandRule& rule = spec.rules.emplace_back();
    rule_rows().read(each, rule);
    read_channels(each, rule);
  }
  return spec;
}

void document_commands(const AddKeys& add) {
  add("commands.", command_rows());
  add("commands.allow.", rule_rows());
}

}  // namespace fieldcast::forward
