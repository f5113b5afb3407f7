#include "tools/forward/outlet/sparkplug/sparkplug_outlet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/message_text.hpp"
#include "tools/forward/outlet/undecodable.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kSection = "sparkplug";
constexpr std::size_t kShown = 256;  // bytes of a topic in the log

std::string state_topic(const std::string& host) { return "spBv1.0/STATE/" + host; }

void log_refused(const std::string& topic, std::string_view reason) {
  log_counted(LogLevel::kWarning, kSection, "commands that were refused or failed",
              fmt::format("{}: {}", printable(topic, kShown), reason));
}

}  // namespace

SparkplugOutlet::SparkplugOutlet(const SparkplugSpec& spec, const OutletContext& context)
    : spec_(spec),
      count_connection_(context.count_connection),
      on_command_(spec.command_user.empty() ? nullptr : context.on_command),
      is_announced_(context.is_announced),
      node_(spec, context.site, context.catalogue),
      session_(spec, kSection, context,
               {.will = [this] { return node_.will(next_number(), read_clocks().utc); },
                .received = [this](const MqttMessage& message) { on_message(message); }}) {}

SparkplugOutlet::~SparkplugOutlet() { session_.close(last_message(), true); }

std::uint64_t SparkplugOutlet::next_number() {
  try {
    return number_ = count_connection_();
  } catch (const StoreError& error) {
    log_counted(LogLevel::kError, kSection, "faults of the queue", error.what());
    return ++number_;
  }
}

std::optional<MqttMessage> SparkplugOutlet::last_message() const {
  if (spec_.version == MqttVersion::k5) return std::nullopt;
  return node_.death(read_clocks().utc);
}

bool SparkplugOutlet::begin_connection(Instant now) {
  connection_ = session_.number();
  connected_ = now;
  is_born_ = false;
  host_ = {};
  return session_.subscribe(node_.command_topic()) &&
         session_.subscribe(node_.device_command_topics()) &&
         (spec_.primary_host.empty() || session_.subscribe(state_topic(spec_.primary_host)));
}

bool SparkplugOutlet::has_host(Instant now) {
  if (spec_.primary_host.empty() || host_.is_online()) return true;
  const std::string offline = fmt::format("primary host {} is offline", spec_.primary_host);
  if (is_born_) {
    is_born_ = false;
    session_.restart(last_message(), true, offline, now);
  } else if (spec_.servers.size() > 1 && now - connected_ > kHostWait) {
    session_.restart(last_message(), true, offline, now);
  }
  return false;
}

bool SparkplugOutlet::is_ready(Instant now) {
  now_ = now;
  if (!session_.look(now)) {
    unconfirmed_.clear();
    return false;
  }
  if (connection_ != session_.number() && !begin_connection(now)) {
    session_.reconnect("cannot subscribe to commands", now);
    return false;
  }
  if (!has_host(now)) return false;
  if (!is_born_ || rebirth_) {
    if (!publish_all(node_.births(read_clocks().utc), now)) return false;
    is_born_ = true;
    rebirth_ = false;
  }
  if (now < next_look_) return true;
  next_look_ = now + kLook;
  return publish_all(node_.deaths(is_announced_, read_clocks().utc), now);
}

bool SparkplugOutlet::publish_all(const std::vector<MqttMessage>& messages, Instant now) {
  return std::ranges::all_of(messages, [&](const MqttMessage& message) {
    return session_.publish(message, std::nullopt, now);
  });
}

// After a request for a rebirth, no data may be sent before it.
std::optional<std::size_t> SparkplugOutlet::send(const Record& record) {
  if (!is_born_ || rebirth_ || !session_.has_space()) return std::nullopt;
  const auto messages = node_.messages(record, read_clocks().utc);
  if (!messages || messages->empty()) {
    if (!messages) log_undecodable(record);
    session_.finish(record.id, messages ? Outcome::kAcknowledged : Outcome::kRefused);
    return 0;
  }
  std::size_t bytes = 0;
  session_.begin(record.id);
  for (const MqttMessage& message : *messages) {
    if (!session_.publish(message, record.id, now_)) return std::nullopt;
    bytes += message.topic.size() + message.payload.size();
  }
  // One confirmation for all messages of this turn (flush()).
  if (spec_.qos == 0) {
    unconfirmed_.push_back(record.id);
  } else {
    session_.end(record.id);
  }
  return bytes;
}

void SparkplugOutlet::flush() {
  if (!unconfirmed_.empty()) session_.end_confirmed(std::exchange(unconfirmed_, {}), now_);
}

std::vector<OutletResult> SparkplugOutlet::take_results() {
  session_.handle_events(now_);
  return session_.take_results();
}

void SparkplugOutlet::on_state(const MqttMessage& message) {
  const bool was_online = host_.is_online();
  if (!host_.on_state(message.payload)) {
    log_counted(LogLevel::kWarning, kSection, "unreadable states of the primary host",
                "the state of the primary host is not the JSON of Sparkplug 3.0; ignored");
  } else if (was_online != host_.is_online()) {
    log_info(kSection, fmt::format("primary host {} is {}", spec_.primary_host,
                                   host_.is_online() ? "online" : "offline"));
  }
}

void SparkplugOutlet::on_message(const MqttMessage& message) {
  if (!spec_.primary_host.empty() && message.topic == state_topic(spec_.primary_host))
    return on_state(message);
  if (message.topic != node_.command_topic()) return on_device_command(message);
  const auto command = decode_command(message.payload);
  if (command && command->rebirth) {
    log_counted(LogLevel::kInfo, kSection, "rebirths", "a host requests a rebirth");
    rebirth_ = true;
  }
  if (!command || !command->metrics.empty())
    log_refused(message.topic, "Node Control/Rebirth is the only command to an edge node");
}

// DCMD has no response: hosts see the new value in DDATA.
void SparkplugOutlet::on_device_command(const MqttMessage& message) {
  if (!on_command_)
    return log_refused(message.topic,
                       "MQTT does not name the user; see 'commands' of the forwarder");
  for (EdgeNode::Write& write : node_.writes(message)) {
    if (!write) {
      log_refused(message.topic, write.error());
      continue;
    }
    on_command_({.user = write->user,
                 .text = to_json(*write),
                 .reply = [topic = message.topic](const std::string& text) {
                   const auto response = command_response_from(text);
                   if (response && response->reason.empty()) return;
                   log_refused(topic, response ? response->reason : "unknown result");
                 }});
  }
}

}  // namespace fieldcast::forward
