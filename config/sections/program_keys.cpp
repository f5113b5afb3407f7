#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program.hpp"
#include "core/program/frame.hpp"

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

constexpr std::pair<std::string_view, LoginProof> kProofs[] = {
    {"password", LoginProof::kPassword},
    {"certificate", LoginProof::kCertificate},
    {"either", LoginProof::kEither},
    {"both", LoginProof::kBoth}};

constexpr std::pair<std::string_view, bool> kPortModes[] = {{"rfc2217", false}, {"raw", true}};

constexpr std::pair<std::string_view, SecondModule> kSeconds[] = {
    {"refuse", SecondModule::kRefuse}, {"replace", SecondModule::kReplace}};

constexpr std::pair<std::string_view, bool> kOpenly[] = {{"none", true}};

Key file_key(std::string_view name, std::string fallback, std::string text) {
  return {.name = name,
          .fallback = std::move(fallback),
          .text = std::move(text),
          .schema = R"({ "type": "string", "minLength": 1 })"};
}

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
          field({.name = "listen",
                 .fallback = "needed",
                 .text =
                     "`ADDRESS:PORT` of this machine. Off the loopback `certificate`, `key` and a "
                     "`store` are demanded: each engineer logs in as a user with the role "
                     "programmer",
                 .example = "listen: 127.0.0.1:4950"},
                &EngineersSpec::listen, ListenRule{4950}),
          {file_key("certificate", "none: plain TCP on the loopback",
                    "a PEM file, relative to this file: TLS")},
          {file_key("key", "none", "its private key, a PEM file that others must not read")},
          {file_key("authority", "none: engineers have no certificates",
                    "a PEM file with who signs the certificates of engineers; an engineer's "
                    "common name is the name of a user")},
          {file_key("revoked", "none", "a list (CRL) of certificates that are not good any more")},
          field({"proof", "password; certificate where there is an `authority`",
                 "what an engineer logs in with; `either` takes one of the two, `both` "
                 "wants both, of the same user"},
                &EngineersSpec::proof, ChoiceRule<LoginProof>{kProofs}),
          field({"login", "off-loopback",
                 "where engineers have to log in, which needs a `store`; with `always` "
                 "everybody who "
                 "connects from this machine logs in too. Without TLS the password crosses "
                 "the loopback as it is"},
                &EngineersSpec::login, ChoiceRule<LoginRule>{kLogins}),
          field({"heartbeat", "5s", "three missed ones free the device"}, &EngineersSpec::heartbeat,
                DurationRule{kMinHeartbeat, kMaxHeartbeat}),
          field({"idle", "10min", "so long without a program byte frees the device"},
                &EngineersSpec::idle, DurationRule{kMinIdle, kMaxIdle}),
          {{.name = "ports",
            .fallback = "none",
            .text = "ports of single devices for software without `fieldcast-port`, see below",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxInterfaces) +
                      R"(, "items": { "$ref": "#/$defs/engineer-port" } })",
            .form = "a list of ports"}},
      });
  return rows;
}

const Rows<EngineerPortSpec>& engineer_port_rows() {
  static const Rows<EngineerPortSpec> rows(
      "engineer-port", "a port of 'engineers'",
      {
          field({.name = "device", .fallback = "needed", .text = "the `number` of the device"},
                &EngineerPortSpec::device, DeviceNumberRule{}),
          field({.name = "listen",
                 .fallback = "needed",
                 .text = "`ADDRESS:PORT` of this machine. Off the loopback `certificate` and `key` "
                         "of `engineers`, or `security: none`, are needed",
                 .example = "listen: 127.0.0.1:4961"},
                &EngineerPortSpec::listen, ListenRule{4961}),
          field({"mode", "rfc2217",
                 "`rfc2217`: Telnet with COM-PORT-OPTION, the software sets the line; `raw`: bytes "
                 "alone, without a login at a prompt"},
                &EngineerPortSpec::raw, ChoiceRule<bool>{kPortModes}),
          field({"user", "any programmer", "the only user that may log in"},
                &EngineerPortSpec::user, TextRule{program::kMaxLoginText}),
          {{.name = "from",
            .fallback = "anywhere",
            .text = "addresses and networks that engineers connect from: `[10.0.7.0/24]`. They "
                    "need no login then, unless `login: always`",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxInterfaces) +
                      R"(, "items": { "type": "string", "minLength": 1 } })"}},
          field({"security", "needed off the loopback without TLS",
                 "`none`: bytes and passwords cross the network as they are"},
                &EngineerPortSpec::without_security, ChoiceRule<bool>{kOpenly}),
      },
      "A port of one device. TLS, login, proof and idle time are those of `engineers`.");
  return rows;
}

const Rows<ModulesSpec>& module_rows() {
  static const Rows<ModulesSpec> rows(
      "modules", "'modules'",
      {
          field({.name = "listen",
                 .fallback = "needed",
                 .text = "`ADDRESS:PORT` of this machine. Off the loopback it has "
                         "to be said who may dial in: `authority`, `secrets`, "
                         "`from`, or `security: none`",
                 .example = "listen: 127.0.0.1:4951"},
                &ModulesSpec::listen, ListenRule{4951}),
          module_row({"ask", "text",
                      "how a module sends its device number: by the `text` that it sends on "
                      "connecting, a line of its own or ended by silence; or in DM `words` of the "
                      "PLC behind it, read with Host Link"},
                     &RegistrationRule::ask, ChoiceRule<RegistrationRule::Ask>{kAsks}),
          module_row({"prefix", "none", "of the text, before the number: `\"ID=\"`"},
                     &RegistrationRule::prefix, TextRule{kMaxPrefix}),
          module_row({"unit", "0", "with `ask: words`: the unit of Host Link"},
                     &RegistrationRule::unit, WholeRule{0, kLastUnit}),
          module_row({"first", "0", "with `ask: words`: the first DM word"},
                     &RegistrationRule::first, WholeRule{0, kLastDmWord}),
          module_row({"words", "8", "with `ask: words`: how many, two characters in each"},
                     &RegistrationRule::words, WholeRule{1, kMaxNumberWords}),
          module_row({"timeout", "5s", "for the number"}, &RegistrationRule::timeout,
                     DurationRule{kMinRegistration, kMaxTimeout}),
          {file_key("certificate", "none: plain TCP", "a PEM file, relative to this file: TLS")},
          {file_key("key", "none", "its private key, a PEM file that others must not read")},
          {file_key(
              "authority", "none: modules have no certificates",
              "a PEM file with the authority of the modules' certificates; a module sends the "
              "number that is its common name")},
          {file_key("revoked", "none", "a list (CRL) of certificates that are not good any more")},
          {{.name = "subjects",
            .fallback = "none",
            .text = "common names that are no numbers, with the number of each, or a list of them",
            .schema = R"({ "type": "object", "additionalProperties": { "anyOf": [ )" +
                      DeviceNumberRule{}.schema() + R"(, { "type": "array", "items": )" +
                      DeviceNumberRule{}.schema() + R"( } ] } })",
            .form = "`{ hut: 17, gateway: [18, 19] }`"}},
          {file_key("secrets", "none",
                    "a text file that others must not read: in each line a number, or `*`, and "
                    "the secret that a module proves to know")},
          {{.name = "from",
            .fallback = "anywhere",
            .text = "addresses and networks that modules dial in from: `[10.0.7.0/24]`",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxInterfaces) +
                      R"(, "items": { "type": "string", "minLength": 1 } })"}},
          field({"second", "refuse",
                 "what happens to a module with the number of one that is connected; "
                 "`replace` lets it take its place"},
                &ModulesSpec::second, ChoiceRule<SecondModule>{kSeconds}),
          field({"security", "needed off the loopback, unless one of the above holds",
                 "`none`: every client that reaches the port may claim to be any module"},
                &ModulesSpec::without_security, ChoiceRule<bool>{kOpenly}),
      });
  return rows;
}

}  // namespace fieldcast::config
