#include "tools/forward/outlet/mqtt/mqtt_session.hpp"

#include <fmt/format.h>

#include <thread>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::forward {

namespace {

constexpr Duration kPause = std::chrono::seconds{1};  // after a failed attempt or a loss
constexpr Duration kClosing = std::chrono::seconds{1};

// Reason codes of MQTT 5 (2.4).
constexpr int kFirstFault = 0x80, kTopicInvalid = 0x90, kTooLarge = 0x95, kFormatInvalid = 0x99;

std::string name_of(const MqttServer& server) {
  return fmt::format("{}://{}:{}", server.tls ? "mqtts" : "mqtt", server.host, server.port);
}

}  // namespace

MqttSession::MqttSession(const MqttServers& spec, std::string section, const OutletContext& context,
                         Handlers handlers)
    : spec_(spec),
      section_(std::move(section)),
      client_id_(spec.client_id.empty() ? "fieldcast-forward-" + context.site : spec.client_id),
      wake_(context.wake),
      handlers_(std::move(handlers)) {}

void MqttSession::open() {
  was_open_ = false;
  client_ = std::make_unique<MqttClient>(
      spec_, MqttClient::Options{spec_.servers[server_], client_id_, handlers_.will(), wake_});
}

void MqttSession::drop(Instant now) {
  client_.reset();
  was_open_ = false;
  server_ = (server_ + 1) % spec_.servers.size();
  next_attempt_ = now + kPause;
  deliveries_.fail_all(results_);
}

bool MqttSession::look(Instant now) {
  if (!client_) {
    if (now < next_attempt_) return false;
    open();
  }
  const MqttState state = client_->state();
  handle_events(now);
  if (!client_) return false;
  if (state == MqttState::kClosed) {
    const std::string server = name_of(spec_.servers[server_]);
    log_counted(LogLevel::kWarning, section_, was_open_ ? "lost connections" : "failed connections",
                was_open_ ? fmt::format("disconnected from {} ({}); the queue keeps all records",
                                        server, client_->reason())
                          : fmt::format("cannot connect to {}: {}; the forwarder tries again",
                                        server, client_->reason()));
    drop(now);
    return false;
  }
  if (state != MqttState::kOpen) return false;
  if (!std::exchange(was_open_, true)) {
    ++number_;
    log_info(section_, "connected to " + name_of(spec_.servers[server_]));
  }
  if (const auto oldest = deliveries_.oldest(); oldest && now - *oldest > spec_.acknowledgement) {
    reconnect("the server does not acknowledge in time", now);
    return false;
  }
  return true;
}

void MqttSession::handle_events(Instant now) {
  if (!client_) return;
  for (const MqttEvent& event : client_->take_events()) {
    switch (event.kind) {
      case MqttEventKind::kReceived: handlers_.received(event.message); break;
      case MqttEventKind::kConfirmed:
        deliveries_.acknowledge(event.id, Outcome::kAcknowledged, results_);
        break;
      case MqttEventKind::kAcknowledged: on_acknowledged(event, now); break;
    }
    if (!client_) return;
  }
}

void MqttSession::on_acknowledged(const MqttEvent& event, Instant now) {
  if (event.reason < kFirstFault) {
    deliveries_.acknowledge(event.id, Outcome::kAcknowledged, results_);
    return;
  }
  const std::string reason = MqttClient::text_of(event.reason);
  if (event.reason == kTooLarge || event.reason == kTopicInvalid ||
      event.reason == kFormatInvalid) {
    log_counted(LogLevel::kError, section_, "messages that the server refuses",
                fmt::format("a message is removed: {}", reason));
    deliveries_.acknowledge(event.id, Outcome::kRefused, results_);
    return;
  }
  const std::string advice =
      fmt::format("the server refuses a message: {}; check the rights of the user", reason);
  if (deliveries_.has(event.id)) return reconnect(advice, now);
  log_counted(LogLevel::kWarning, section_, "states that the server refuses", advice);
}

bool MqttSession::publish(const MqttMessage& message, std::optional<std::uint64_t> record,
                          Instant now) {
  if (!client_) return false;
  const auto id = client_->publish(message);
  if (id) {
    if (record && message.qos > 0) deliveries_.add(*record, *id, now);
    return true;
  }
  if (id.error() == MqttClient::Fault::kNotSent) {
    reconnect("a message cannot be sent", now);
    return false;
  }
  log_counted(
      LogLevel::kError, section_, "messages that the server refuses",
      fmt::format("{}: a message of {} bytes is removed: {}", message.topic, message.payload.size(),
                  id.error() == MqttClient::Fault::kTooLarge
                      ? "the server limits the size of a packet; increase this limit"
                      : "its topic is not allowed"));
  if (record) deliveries_.refuse(*record);
  return true;
}

void MqttSession::end_confirmed(const std::vector<std::uint64_t>& records, Instant now) {
  if (!client_) return;  // all records have failed
  const auto id = client_->confirm();
  if (!id) {
    reconnect("a message cannot be sent", now);
    return;
  }
  for (const std::uint64_t record : records) {
    deliveries_.add(record, *id, now);
    end(record);
  }
}

void MqttSession::reconnect(const std::string& reason, Instant now) {
  log_counted(LogLevel::kWarning, section_, "lost connections",
              fmt::format("disconnects from {}: {}; the queue keeps all records",
                          name_of(spec_.servers[server_]), reason));
  drop(now);
}

void MqttSession::restart(const std::optional<MqttMessage>& last, bool publish_will,
                          const std::string& reason, Instant now) {
  close(last, publish_will);
  reconnect(reason, now);
}

// The server closes a connection without reading its DISCONNECT if it cannot send a PUBACK, and
// then publishes the will.
void MqttSession::wait_for_acknowledgements() {
  const Instant limit = steady_now() + kClosing;
  while (client_ && client_->state() == MqttState::kOpen && deliveries_.messages() != 0 &&
         steady_now() < limit) {
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
    handle_events(steady_now());
  }
}

void MqttSession::close(const std::optional<MqttMessage>& last, bool publish_will) {
  constexpr std::uint64_t kNoRecord = 0;
  if (client_ && client_->state() == MqttState::kOpen) {
    if (last) (void)publish(*last, kNoRecord, steady_now());
    wait_for_acknowledgements();
    if (client_) client_->close(publish_will);
  }
  client_.reset();
  deliveries_.fail_all(results_);
  std::erase_if(results_, [](const OutletResult& result) { return result.record == kNoRecord; });
}

std::vector<OutletResult> MqttSession::take_results() { return std::exchange(results_, {}); }

}  // namespace fieldcast::forward
