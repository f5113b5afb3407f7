// The state of the notifications: counters, targets and the newest messages.
#include "bridge/store/notification_table.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/api_routes.hpp"
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

std::string report_json(const Notifier::Report& report, std::string_view messages) {
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
    return reply(json_response(report_json({}, "[]"), request.accepts_gzip));
  api.database->respond(
      [report = api.notifier->report(), compress = request.accepts_gzip](SqlConnection& store) {
        const auto messages = NotificationTable(store).newest(kNewest);
        return json_response(
            report_json(report, json_array(messages,
                                           [](std::string& out, const QueuedNotification& each) {
                                             out += message_json(each);
                                           })),
            compress);
      },
      reply);
}

}  // namespace fieldcast::web
