#include "tools/forward/outlet/mqtt/mqtt_outlet.hpp"

#include <algorithm>
#include <utility>

#include "tools/forward/outlet/undecodable.hpp"

namespace fieldcast::forward {

MqttOutlet::MqttOutlet(const MqttSpec& spec, OutletContext context)
    : is_announced_(context.is_announced),
      messages_(spec, context.site, context.catalogue),
      session_(spec, "mqtt", context,
               {.will = [this] { return messages_.status(false); },
                .received = [](const MqttMessage&) {}}) {}

MqttOutlet::~MqttOutlet() { session_.close(messages_.status(false), false); }

bool MqttOutlet::is_ready(Instant now) {
  now_ = now;
  if (!session_.look(now)) return false;
  const bool is_new = std::exchange(announced_, session_.number()) != session_.number();
  if (is_new && !publish_all({messages_.status(true)})) return false;
  if (!is_new && now < next_look_) return true;
  next_look_ = now + kLook;
  return publish_all(messages_.device_status(is_announced_, is_new));
}

bool MqttOutlet::publish_all(const std::vector<MqttMessage>& messages) {
  return std::ranges::all_of(messages, [this](const MqttMessage& message) {
    return session_.publish(message, std::nullopt, now_);
  });
}

std::optional<std::size_t> MqttOutlet::send(const Record& record) {
  if (!session_.has_space()) return std::nullopt;
  const auto messages = messages_.of(record);
  if (!messages) {
    log_undecodable(record);
    session_.finish(record.id, Outcome::kRefused);
    return 0;
  }
  std::size_t bytes = 0;
  session_.begin(record.id);
  for (const MqttMessage& message : *messages) {
    if (!session_.publish(message, record.id, now_)) return std::nullopt;
    bytes += message.topic.size() + message.payload.size();
  }
  session_.end(record.id);
  return bytes;
}

void MqttOutlet::report(const SiteStatus& status) {
  (void)session_.publish(messages_.site(status), std::nullopt, now_);
}

// Acknowledgements arrive as events of the session.
std::vector<OutletResult> MqttOutlet::take_results() {
  session_.handle_events(now_);
  return session_.take_results();
}

}  // namespace fieldcast::forward
