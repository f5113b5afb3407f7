#include "config/keys/bridge_keys.hpp"
#include "config/limits.hpp"
#include "config/port.hpp"
#include "config/program.hpp"
#include "config/scalars.hpp"

namespace fieldcast::config {
namespace {

using program::RegistrationRule;

constexpr Duration kMinHeartbeat = std::chrono::seconds{1},
                   kMaxHeartbeat = std::chrono::minutes{10};
constexpr Duration kMinIdle = std::chrono::seconds{10}, kMaxIdle = std::chrono::hours{24};
constexpr Duration kMinRegistration = std::chrono::milliseconds{100};
constexpr std::uint32_t kLastDmWord = 32767;
constexpr std::uint16_t kLastUnit = 31, kMaxNumberWords = 8;
constexpr std::size_t kMaxPrefix = 32;

constexpr std::pair<std::string_view, RegistrationRule::Ask> kAsks[] = {
    {"text", RegistrationRule::Ask::kText}, {"words", RegistrationRule::Ask::kWords}};

constexpr std::pair<std::string_view, LoginRule> kLogins[] = {
    {"off-loopback", LoginRule::kOffLoopback}, {"always", LoginRule::kAlways}};

template <typename T, typename Rule>
Field<ModulesSpec> module_row(Key key, T RegistrationRule::*member, Rule rule) {
  return field<ModulesSpec>(
      std::move(key), [member](ModulesSpec& modules) -> T& { return modules.registration.*member; },
      rule);
}

}  // namespace

const Rows<ProgramSpec>& program_rows() {
  static const Rows<ProgramSpec> rows(
      "program", "'program'",
      {
          {{.name = "engineers",
            .fallback = "nobody programs through the bridge",
            .text = "where `fieldcast-port` connects, see below",
            .schema = R"({ "$ref": "#/$defs/engineers" })"}},
          {{.name = "modules",
            .fallback = "nothing dials in",
            .text = "where serial-to-network modules dial in, see below",
            .schema = R"({ "$ref": "#/$defs/modules" })"}},
      },
      "Where programming software and modules that dial in reach the bridge.");
  return rows;
}

const Rows<EngineersSpec>& engineer_rows() {
  static const Rows<EngineersSpec> rows(
      "engineers", "'engineers'",
      {
          field<EngineersSpec>(
              {.name = "listen",
               .fallback = "needed",
               .text =
                   "`ADDRESS:PORT` of this machine. Off the loopback `certificate`, `key` and a "
                   "`store` are demanded: each engineer logs in as a user with the role "
                   "programmer",
               .example = "listen: 127.0.0.1:4950"},
              &EngineersSpec::listen, ListenRule{4950}),
          {{.name = "certificate",
            .fallback = "none: plain TCP on the loopback",
            .text = "a PEM file, relative to this file: TLS",
            .schema = R"({ "type": "string", "minLength": 1 })"}},
          {{.name = "key",
            .fallback = "none",
            .text = "its private key, a PEM file",
            .schema = R"({ "type": "string", "minLength": 1 })"}},
          field<EngineersSpec>(
              {.name = "login",
               .fallback = "off-loopback",
               .text =
                   "where engineers have to log in, which needs a `store`; with `always` whoever "
                   "connects from this machine logs in too. Without TLS the password crosses "
                   "the loopback as it is"},
              &EngineersSpec::login, ChoiceRule<LoginRule>{kLogins}),
          field<EngineersSpec>(
              {.name = "heartbeat", .fallback = "5s", .text = "three missed ones free the device"},
              &EngineersSpec::heartbeat, DurationRule{kMinHeartbeat, kMaxHeartbeat}),
          field<EngineersSpec>({.name = "idle",
                                .fallback = "10min",
                                .text = "so long without a program byte frees the device"},
                               &EngineersSpec::idle, DurationRule{kMinIdle, kMaxIdle}),
      });
  return rows;
}

const Rows<ModulesSpec>& module_rows() {
  static const Rows<ModulesSpec> rows(
      "modules", "'modules'",
      {
          field<ModulesSpec>({.name = "listen",
                              .fallback = "needed",
                              .text = "`ADDRESS:PORT` of this machine",
                              .example = "listen: 127.0.0.1:4951"},
                             &ModulesSpec::listen, ListenRule{4951}),
          module_row(
              {.name = "ask",
               .fallback = "text",
               .text = "how a module tells its device number: by the `text` that it sends on "
                       "connecting, a line of its own or ended by silence; or in DM `words` of the "
                       "PLC behind it, read with Host Link"},
              &RegistrationRule::ask, ChoiceRule<RegistrationRule::Ask>{kAsks}),
          module_row({.name = "prefix",
                      .fallback = "none",
                      .text = "of the text, before the number: `\"ID=\"`"},
                     &RegistrationRule::prefix, TextRule{kMaxPrefix}),
          module_row(
              {.name = "unit", .fallback = "0", .text = "with `ask: words`: the unit of Host Link"},
              &RegistrationRule::unit, WholeRule{0, kLastUnit}),
          module_row(
              {.name = "first", .fallback = "0", .text = "with `ask: words`: the first DM word"},
              &RegistrationRule::first, WholeRule{0, kLastDmWord}),
          module_row({.name = "words",
                      .fallback = "8",
                      .text = "with `ask: words`: how many, two characters in each"},
                     &RegistrationRule::words, WholeRule{1, kMaxNumberWords}),
          module_row({.name = "timeout", .fallback = "5s", .text = "for the number"},
                     &RegistrationRule::timeout, DurationRule{kMinRegistration, kMaxTimeout}),
      });
  return rows;
}

}  // namespace fieldcast::config
