// Rules and targets of notifications about alarms. Plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/model/channel_kind.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/forward/outlet/http/http_spec.hpp"
#include "tools/station/notify/hours.hpp"

namespace fieldcast::web {

struct MailSpec {
  std::string server;     // "smtp://HOST:PORT" with STARTTLS, "smtps://HOST:PORT"; empty: no mail
  std::string from;       // "station@plant.example"
  std::string authority;  // PEM file that signed the server's certificate; empty: the system's
  std::string user, password_file;
  bool without_tls = false;
};

struct NotifyTarget {
  std::string name;
  std::vector<std::string> mail;  // addresses; empty: a webhook
  forward::HttpSpec webhook;
  std::string url_file;     // a file with the URL, instead of `webhook.server`
  std::string secret_file;  // of the signature; empty: not signed
};

struct Escalation {
  Duration after{};  // after the first message
  std::vector<std::string> to;
};

struct NotifyRule {
  std::string name;
  std::vector<std::string> to;  // names of targets
  std::vector<Pattern> patterns{Pattern{}};
  AlarmPriority priority = AlarmPriority::kLow;  // the least
  std::vector<HoursSpan> hours;                  // of local time; empty: always
  Duration delay{};
  Duration repeat{};  // 0: never
  std::uint32_t repeats = 10;
  bool cleared = false;
  std::vector<Escalation> escalate;  // in the order of time
  std::uint32_t digest = 10;         // messages of a window; further ones are one digest
  Duration digest_within = std::chrono::minutes{5};
};

struct HeartbeatSpec {
  forward::HttpSpec http;  // empty server: none
  std::string url_file;    // a file with the URL, instead of `http.server`
  bool get = false;        // GET instead of POST
  Duration every = std::chrono::minutes{1};
};

struct NotifySpec {
  std::string link;  // address of the page, without the last '/'; empty: no link
  Duration keep = std::chrono::hours{24};
  std::uint32_t queue = 10'000;  // waiting messages
  MailSpec mail;
  std::vector<NotifyTarget> targets;
  std::vector<NotifyRule> rules;
  HeartbeatSpec heartbeat;
};

}  // namespace fieldcast::web
