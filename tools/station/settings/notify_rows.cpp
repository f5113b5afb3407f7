#include "tools/station/settings/notify_rows.hpp"

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/station/settings/text_list.hpp"

namespace fieldcast::web {
namespace {

using config::DurationRule;
using config::field;
using config::Rows;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr std::pair<std::string_view, AlarmPriority> kPriorities[] = {
    {"low", AlarmPriority::kLow},
    {"medium", AlarmPriority::kMedium},
    {"high", AlarmPriority::kHigh},
    {"critical", AlarmPriority::kCritical}};
constexpr std::pair<std::string_view, bool> kMethods[] = {{"post", false}, {"get", true}};

template <class Owner>
config::Field<Owner> plain(const char* name, const char* fallback, const char* text,
                           std::string_view schema = "{}") {
  return {{.name = name, .fallback = fallback, .text = text, .schema = std::string(schema)}};
}

}  // namespace

const Rows<NotifySpec>& notify_rows() {
  static const Rows<NotifySpec> rows(
      "notify", "'notify'",
      {
          field<NotifySpec>({.name = "link",
                             .fallback = "none",
                             .text = "address of the page, such as `https://station.plant`, for "
                                     "the links in messages"},
                            &NotifySpec::link, config::TextRule{config::kMaxPath}),
          field<NotifySpec>({.name = "keep",
                             .fallback = "`1d`",
                             .text = "a message that cannot be sent in this time is given up"},
                            &NotifySpec::keep, DurationRule{minutes{1}, hours{24 * 30}}),
          field<NotifySpec>({.name = "queue",
                             .fallback = "`10000`",
                             .text = "waiting messages; beyond them, the oldest is dropped"},
                            &NotifySpec::queue, config::WholeRule{10, 1'000'000}),
          plain<NotifySpec>("mail", "none", "the mail server: `server`, .."),
          plain<NotifySpec>("targets", "[]", "who is notified: a list of maps, each with a `name`"),
          plain<NotifySpec>("rules", "[]", "when: a list of maps, each with a `name` and `to`"),
          plain<NotifySpec>("heartbeat", "none",
                            "requests to a server that notices their absence: `url`, .."),
      },
      "Notifies of alarms by mail and webhook.");
  return rows;
}

const Rows<MailSpec>& mail_rows() {
  static const Rows<MailSpec> rows(
      "mail", "'mail'",
      {
          field<MailSpec>({.name = "server",
                           .fallback = std::string(config::kNeeded),
                           .text = "`smtp://HOST:PORT` with STARTTLS, or `smtps://HOST:PORT`"},
                          &MailSpec::server, config::TextRule{config::kMaxPath}),
          field<MailSpec>({.name = "from",
                           .fallback = std::string(config::kNeeded),
                           .text = "mail address of the sender"},
                          &MailSpec::from, config::TextRule{kMaxAddress}),
          plain<MailSpec>("authority", "those of the system",
                          "a PEM file with the authorities of the server's certificate"),
          field<MailSpec>({.name = "user", .fallback = "none", .text = "with `password-file`"},
                          &MailSpec::user, config::TextRule{256}),
          plain<MailSpec>("password-file", "none", "a file whose first line is the password"),
          field<MailSpec>(
              {.name = "without-tls",
               .fallback = "`false`",
               .text = "sends mails and the login without TLS, readable in the network"},
              &MailSpec::without_tls, config::FlagRule{}),
      },
      "The mail server.");
  return rows;
}

const Rows<NotifyTarget>& target_rows() {
  static const Rows<NotifyTarget> rows(
      "target", "a target",
      {
          field<NotifyTarget>({.name = "name",
                               .fallback = std::string(config::kNeeded),
                               .text = "by which rules name it"},
                              &NotifyTarget::name, config::NameRule{}),
          plain<NotifyTarget>("mail", "none", "mail addresses; each gets a mail of its own",
                              kTextList),
          field<NotifyTarget>(
              {.name = "webhook",
               .fallback = "none",
               .text = "`https://HOST:PORT/PATH` that receives each message as JSON by POST"},
              [](NotifyTarget& target) -> std::string& { return target.webhook.server; },
              config::TextRule{config::kMaxPath}),
          plain<NotifyTarget>("webhook-file", "none",
                              "a file whose first line is the URL, if the URL is a secret"),
          plain<NotifyTarget>("secret-file", "not signed",
                              "a file whose first line is the key of the signature"),
          plain<NotifyTarget>("token-file", "none",
                              "a file whose first line is the token of `Authorization: Bearer`"),
          plain<NotifyTarget>("authority", "those of the system",
                              "a PEM file with the authorities of the server's certificate"),
          field<NotifyTarget>(
              {.name = "without-tls",
               .fallback = "`false`",
               .text = "allows `http://` off this machine: messages are readable in the network"},
              [](NotifyTarget& target) -> bool& { return target.webhook.without_tls; },
              config::FlagRule{}),
      },
      "A person, a group or a program that is notified.", {"mail", "webhook", "webhook-file"});
  return rows;
}

const Rows<Escalation>& escalation_rows() {
  static const Rows<Escalation> rows(
      "escalation", "an escalation",
      {
          field<Escalation>({.name = "after",
                             .fallback = std::string(config::kNeeded),
                             .text = "the first message, if nobody has acknowledged the alarm",
                             .example = "after: 15min"},
                            &Escalation::after, DurationRule{minutes{1}, hours{24 * 7}}),
          plain<Escalation>("to", "needed", "names of targets", kTextList),
      },
      "Further targets for an alarm that nobody acknowledges.");
  return rows;
}

const Rows<NotifyRule>& rule_rows() {
  static const Rows<NotifyRule> rows(
      "rule", "a rule",
      {
          field<NotifyRule>({.name = "name",
                             .fallback = std::string(config::kNeeded),
                             .text = "in messages; a renamed rule is a new one"},
                            &NotifyRule::name, config::NameRule{}),
          plain<NotifyRule>("to", "needed", "names of targets", kTextList),
          plain<NotifyRule>("patterns", "[\"*\"]: all",
                            "patterns `BUS/DEVICE/CHANNEL` of the channels", kTextList),
          field<NotifyRule>({.name = "priority",
                             .fallback = "`low`: all",
                             .text = "the least priority of an alarm"},
                            &NotifyRule::priority, config::ChoiceRule<AlarmPriority>{kPriorities}),
          plain<NotifyRule>("hours", "always",
                            "such as `mon-fri 18:00-06:00` or `sat-sun`, in local time; outside of "
                            "them messages wait",
                            kTextList),
          field<NotifyRule>({.name = "delay",
                             .fallback = "`0s`",
                             .text = "an alarm that ends or is acknowledged before is not sent"},
                            &NotifyRule::delay, DurationRule{Duration{}, hours{24}}),
          field<NotifyRule>({.name = "repeat",
                             .fallback = "never",
                             .text = "time between messages until somebody acknowledges the alarm"},
                            &NotifyRule::repeat, DurationRule{minutes{1}, hours{24 * 7}}),
          field<NotifyRule>({.name = "repeats", .fallback = "`10`", .text = "of an alarm, at most"},
                            &NotifyRule::repeats, config::WholeRule{1, 1000}),
          field<NotifyRule>({.name = "cleared",
                             .fallback = "`false`",
                             .text = "also sends the end of an alarm whose start was sent"},
                            &NotifyRule::cleared, config::FlagRule{}),
          plain<NotifyRule>("escalate", "[]", "a list of `{ after: 15min, to: [NAME] }`"),
          field<NotifyRule>({.name = "digest",
                             .fallback = "`10`",
                             .text = "messages to a target in `digest-within`; further ones become "
                                     "one message; `0`: never"},
                            &NotifyRule::digest, config::WholeRule{0, 1000}),
          field<NotifyRule>({.name = "digest-within",
                             .fallback = "`5min`",
                             .text = "from the first message; the digest is sent at its end"},
                            &NotifyRule::digest_within, DurationRule{seconds{10}, hours{24}}),
      },
      "Which alarms are sent to whom, and when.");
  return rows;
}

const Rows<HeartbeatSpec>& heartbeat_rows() {
  static const Rows<HeartbeatSpec> rows(
      "heartbeat", "'heartbeat'",
      {
          field<HeartbeatSpec>(
              {.name = "url",
               .fallback = "none",
               .text = "`https://HOST:PORT/PATH` that is requested while the station works"},
              [](HeartbeatSpec& spec) -> std::string& { return spec.http.server; },
              config::TextRule{config::kMaxPath}),
          plain<HeartbeatSpec>("url-file", "none",
                               "a file whose first line is the URL, if the URL is a secret"),
          field<HeartbeatSpec>(
              {.name = "every", .fallback = "`1min`", .text = "time between requests"},
              &HeartbeatSpec::every, DurationRule{seconds{1}, hours{24}}),
          field<HeartbeatSpec>({.name = "method", .fallback = "`post`", .text = "of the requests"},
                               &HeartbeatSpec::get, config::ChoiceRule<bool>{kMethods}),
          plain<HeartbeatSpec>("authority", "those of the system",
                               "a PEM file with the authorities of the server's certificate"),
          field<HeartbeatSpec>(
              {.name = "without-tls",
               .fallback = "`false`",
               .text = "allows `http://` off this machine"},
              [](HeartbeatSpec& spec) -> bool& { return spec.http.without_tls; },
              config::FlagRule{}),
      },
      "Requests by whose absence a server notices that the station has failed.",
      {"url", "url-file"});
  return rows;
}

std::vector<std::pair<std::string, const config::RowTable*>> notify_tables() {
  return {{"notify.", &notify_rows()},
          {"notify.mail.", &mail_rows()},
          {"notify.targets.", &target_rows()},
          {"notify.rules.", &rule_rows()},
          {"notify.rules.escalate.", &escalation_rows()},
          {"notify.heartbeat.", &heartbeat_rows()}};
}

}  // namespace fieldcast::web
