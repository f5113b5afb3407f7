#include "tools/station/settings/notify_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "config/document/scalars.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/server_address.hpp"
#include "tools/station/settings/item_list.hpp"
#include "tools/station/settings/notify_rows.hpp"
#include "tools/station/settings/text_list.hpp"

namespace fieldcast::web {
namespace {

using config::MapReader;

constexpr std::size_t kMaxTargets = 16, kMaxRules = 64, kMaxEscalations = 8;

std::string fault_of_address(const std::string& text) {
  const std::size_t at = text.find('@');
  const bool good = at != 0 && at != text.npos && at + 1 < text.size() &&
                    text.find('@', at + 1) == text.npos && text.size() <= kMaxAddress &&
                    std::all_of(text.begin(), text.end(), [](unsigned char c) {
                      return c > ' ' && c < 0x7F &&
                             std::string_view("<>(),;:\\\"[]").find(static_cast<char>(c)) ==
                                 std::string_view::npos;
                    });
  return good ? "" : fmt::format("'{}' is not a mail address", text);
}

struct UrlForm {
  std::string_view plain, tls, example;
  bool is_plain_safe = false;  // the plain scheme starts TLS too
};
constexpr UrlForm kHttp{"http://", "https://", "https://HOST:PORT/PATH"};
constexpr UrlForm kSmtp{"smtp://", "smtps://", "smtp://HOST:587", true};

void check_url(MapReader& map, std::string_view key, const std::string& url, const UrlForm& form,
               bool without_tls) {
  const bool tls = url.starts_with(form.tls);
  if (!tls && !url.starts_with(form.plain))
    return map.fault(key, fmt::format("{} does not begin with {} or {}", key, form.plain, form.tls),
                     form.example);
  const std::string rest = url.substr(tls ? form.tls.size() : form.plain.size());
  const std::string place = rest.substr(0, rest.find_first_of("/?#"));
  if (place.find('@') != place.npos)
    return map.fault(key, fmt::format("{} contains a login", key),
                     "the login belongs to a file that only the station may read");
  const std::string host = place.starts_with('[') ? place.substr(1, place.find(']') - 1)
                                                  : place.substr(0, place.find(':'));
  if (host.empty() || url.find(' ') != url.npos)
    return map.fault(key, fmt::format("{} names no host", key), form.example);
  if (!tls && !form.is_plain_safe && !without_tls && !forward::is_loopback(host))
    map.fault(key, fmt::format("{} is off this machine and without TLS", key),
              fmt::format("{}, or without-tls: true if the network is trusted", form.example));
}

void read_mail(MapReader& notify, config::Library& library, MailSpec& spec) {
  const config::Node* node = notify.find("mail");
  if (node == nullptr) return;
  MapReader map(*node, mail_rows(), notify.faults());
  mail_rows().read(map, spec);
  forward::read_files(map, library,
                      {{"authority", &spec.authority}, {"password-file", &spec.password_file}});
  forward::check_pair(map, "user", spec.user, "password-file", spec.password_file, "both");
  if (!spec.server.empty()) check_url(map, "server", spec.server, kSmtp, true);
  if (const std::string wrong = spec.from.empty() ? "" : fault_of_address(spec.from);
      !wrong.empty())
    map.fault("from", "from: " + wrong, "station@plant.example");
}

void read_target(MapReader& map, config::Library& library, bool has_mail, NotifyTarget& target) {
  target_rows().read(map, target);
  forward::read_files(map, library,
                      {{"webhook-file", &target.url_file},
                       {"secret-file", &target.secret_file},
                       {"token-file", &target.webhook.token_file},
                       {"authority", &target.webhook.authority}});
  read_texts(map, "mail", "a mail address such as ann@plant.example", target.mail,
             fault_of_address);
  if (!target.webhook.server.empty())
    check_url(map, "webhook", target.webhook.server, kHttp, target.webhook.without_tls);
  const bool is_mail = map.has("mail");
  if (is_mail && (map.has("webhook") || map.has("webhook-file")))
    map.fault("mail", "one target for mail and a webhook", "a target for each");
  if (!is_mail && !map.has("webhook") && !map.has("webhook-file"))
    map.fault("name", "a target without mail and without a webhook",
              "mail: [ann@plant.example], or webhook: https://HOST:PORT/PATH");
  if (map.has("webhook") && map.has("webhook-file"))
    map.fault("webhook", "'webhook' and 'webhook-file' in one target", "one of them");
  if (is_mail && !has_mail)
    map.fault("mail", "a target for mail without a mail server",
              "notify: { mail: { server: smtp://HOST:587, from: station@plant.example } }");
}

using Names = std::set<std::string>;

void read_to(MapReader& map, const Names& targets, std::vector<std::string>& to) {
  if (map.require("to", "to: [NAME], names of targets") == nullptr) return;
  read_texts(map, "to", "the name of a target", to, [&](const std::string& name) {
    return targets.contains(name) ? "" : fmt::format("to: '{}' is not a target", name);
  });
  if (to.empty()) map.fault("to", "to names no target", "to: [NAME]");
}

void read_escalations(MapReader& map, const Names& targets, NotifyRule& rule) {
  const config::Node* node = map.find("escalate");
  if (node == nullptr || !config::is_list(*node, "escalate", 1, kMaxEscalations,
                                          "a list of { after: 15min, to: [NAME] }", map.faults()))
    return;
  for (const config::Node* item : node->items) {
    MapReader step(*item, escalation_rows(), map.faults());
    Escalation& escalation = rule.escalate.emplace_back();
    escalation_rows().read(step, escalation);
    read_to(step, targets, escalation.to);
    const std::size_t count = rule.escalate.size();
    if (count > 1 && escalation.after < rule.escalate[count - 2].after)
      step.fault("after", "an escalation earlier than the one before it", "the order of time");
  }
}

void read_rule(MapReader& map, const Names& targets, NotifyRule& rule) {
  rule_rows().read(map, rule);
  read_to(map, targets, rule.to);
  std::vector<std::string> patterns, spans;
  read_texts(map, "patterns", "BUS/DEVICE/CHANNEL with *", patterns, [](const std::string& text) {
    const auto pattern = Pattern::parse(text);
    return pattern ? "" : "patterns: " + pattern.error();
  });
  read_texts(map, "hours", kHoursForm, spans, [](const std::string& text) {
    return hours_from(text) ? "" : fmt::format("hours: '{}' is not a time of the week", text);
  });
  if (!patterns.empty()) rule.patterns.clear();
  for (const std::string& text : patterns)
    rule.patterns.push_back(Pattern::parse(text).value_or(Pattern{}));
  for (const std::string& text : spans)
    rule.hours.push_back(hours_from(text).value_or(HoursSpan{}));
  read_escalations(map, targets, rule);
}

void read_heartbeat(MapReader& notify, config::Library& library, HeartbeatSpec& spec) {
  const config::Node* node = notify.find("heartbeat");
  if (node == nullptr) return;
  MapReader map(*node, heartbeat_rows(), notify.faults());
  heartbeat_rows().read(map, spec);
  forward::read_files(map, library,
                      {{"url-file", &spec.url_file}, {"authority", &spec.http.authority}});
  if (map.has("url") == map.has("url-file"))
    map.fault("url", "a heartbeat needs one of 'url' and 'url-file'", kHttp.example);
  if (!spec.http.server.empty())
    check_url(map, "url", spec.http.server, kHttp, spec.http.without_tls);
}

}  // namespace

void read_notify(MapReader& file, config::Library& library, std::optional<NotifySpec>& spec) {
  const config::Node* node = file.find("notify");
  if (node == nullptr) return;
  if (!file.has("store"))
    file.fault("notify", "nobody can be notified without a store, which keeps the messages",
               "store: { path: FILE }");
  MapReader map(*node, notify_rows(), file.faults());
  NotifySpec& read = spec.emplace();
  notify_rows().read(map, read);
  while (read.link.ends_with('/')) read.link.pop_back();
  if (!read.link.empty()) check_url(map, "link", read.link, kHttp, true);
  read_mail(map, library, read.mail);
  read_items(map, "targets", target_rows(), kMaxTargets, read.targets,
             [&](MapReader& item, NotifyTarget& target) {
               read_target(item, library, map.has("mail"), target);
             });
  Names targets;
  for (const NotifyTarget& target : read.targets) targets.insert(target.name);
  read_items(map, "rules", rule_rows(), kMaxRules, read.rules,
             [&](MapReader& item, NotifyRule& rule) { read_rule(item, targets, rule); });
  read_heartbeat(map, library, read.heartbeat);
}

}  // namespace fieldcast::web
