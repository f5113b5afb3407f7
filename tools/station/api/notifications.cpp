// The state of the notifications: counters, targets and the newest messages.
#include <nlohmann/json.hpp>

#include "bridge/store/notification_table.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/audit_note.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {
namespace {

constexpr std::int64_t kNewest = 50;

std::string target_json(const Notifier::TargetState& target) {
  return JsonObject()
      .add("name", target.name)
      .add("kind", target.is_mail ? "mail" : "webhook")
      .add("sent_ms", target.sent_at)
      .add("error", target.error)
      .take();
}

std::string message_json(const QueuedNotification& message) {
  return JsonObject()
      .add("id", message.id)
      .add("target", message.target)
      .add("recipient", message.recipient)
      .add("subject", message.subject)
      .add("state", message.state)
      .add("made_ms", message.made_at)
      .add("done_ms", message.done_at)
      .add("attempts", message.attempts)
      .add("error", message.error)
      .take();
}

std::string rule_json(const NotifyRule& rule) {
  Json patterns = Json::array(), hours = Json::array(), escalate = Json::array();
  for (const Pattern& pattern : rule.patterns) patterns.push_back(pattern.text());
  for (const HoursSpan& span : rule.hours) hours.push_back(to_text(span));
  for (const Escalation& step : rule.escalate)
    escalate.push_back({{"after_ms", milliseconds(step.after)}, {"to", step.to}});
  return Json{{"name", rule.name},
              {"to", rule.to},
              {"patterns", patterns},
              {"priority", to_text(rule.priority)},
              {"hours", hours},
              {"delay_ms", milliseconds(rule.delay)},
              {"repeat_ms", milliseconds(rule.repeat)},
              {"repeats", rule.repeats},
              {"cleared", rule.cleared},
              {"escalate", escalate},
              {"digest", rule.digest},
              {"digest_within_ms", milliseconds(rule.digest_within)}}
      .text();
}

std::string report_json(const Notifier::Report& report, const std::vector<NotifyRule>& rules,
                        std::string_view messages) {
  const Outbox::Counters& counters = report.counters;
  return JsonObject()
      .add("waiting", counters.waiting)
      .add("sent", counters.sent)
      .add("failed", counters.failed)
      .add("lost", counters.lost)
      .add_json("targets", json_array(report.targets,
                                      [](std::string& out, const Notifier::TargetState& target) {
                                        out += target_json(target);
                                      }))
      .add_json("rules", json_array(rules, [](std::string& out,
                                              const NotifyRule& rule) { out += rule_json(rule); }))
      .add_json("messages", messages)
      .take();
}

}  // namespace

std::vector<Metric> metrics_of(const Notifier* notifier) {
  std::vector<Metric> all;
  if (notifier == nullptr) return all;
  const Notifier::Report report = notifier->report();
  const auto add = [&all](const char* name, bool counter, const char* help, auto value) {
    all.push_back({name, counter, help, static_cast<double>(value)});
  };
  add("notifications_waiting", false, "Messages that wait to be sent.", report.counters.waiting);
  add("notifications_sent_total", true, "Messages that a server has accepted.",
      report.counters.sent);
  add("notifications_failed_total", true, "Attempts to send a message that failed.",
      report.counters.failed);
  add("notifications_lost_total", true, "Messages that were too old or exceeded the queue.",
      report.counters.lost);
  add("heartbeats_total", true, "Heartbeats that the server has accepted.", report.beats);
  add("heartbeats_failed_total", true, "Heartbeats that failed.", report.failed_beats);
  return all;
}

void show_notifications(const Api& api, const HttpRequest& request, const Caller&,
                        const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  if (api.notifier == nullptr || api.database == nullptr)
    return reply(json_response(report_json({}, {}, "[]"), request.accepts_gzip));
  api.database->respond(
      [notifier = api.notifier, compress = request.accepts_gzip](SqlConnection& store) {
        const auto messages = NotificationTable(store).newest(kNewest);
        return json_response(
            report_json(notifier->report(), notifier->rules(),
                        json_array(messages,
                                   [](std::string& out, const QueuedNotification& each) {
                                     out += message_json(each);
                                   })),
            compress);
      },
      reply);
}

void test_notification(const Api& api, const HttpRequest& request, const Caller& caller,
                       const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  const auto target = body->find("target");
  const bool is_known = api.notifier != nullptr && body->size() == 1 && target != body->end() &&
                        target->is_string() && api.notifier->has_target(target->get<std::string>());
  if (!is_known)
    return reply(error_response(404, "target: this is not a target of 'notify'",
                                "GET /api/notifications lists them"));
  const auto name = target->get<std::string>();
  // The thread of the database may wait for it.
  api.database->respond(
      [notifier = api.notifier, name](SqlConnection&) {
        if (notifier->queue_test(name)) return json_response("{}");
        return error_response(503, "the store is not available now", "try again later");
      },
      noting(api, caller, "test notification", name, reply));
}

}  // namespace fieldcast::web
