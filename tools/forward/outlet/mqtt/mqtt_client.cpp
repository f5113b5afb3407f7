#include "tools/forward/outlet/mqtt/mqtt_client.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <pthread.h>

#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/process/secret.hpp"

namespace fieldcast::forward {

namespace {

constexpr Duration kOpening = std::chrono::seconds{5};  // until CONNACK
constexpr Duration kLeaving = std::chrono::seconds{1};
constexpr int kKeepAlive = 10;  // seconds
constexpr int kTurnMs = 200;    // longest wait of the library's loop
constexpr int kAllInFlight = 65'535;
// Without an authority: those of the system, in Debian's directory.
constexpr const char* kSystemAuthorities = "/etc/ssl/certs";
constexpr const char* kConfirmation = "fieldcast-forward/confirm";

// The library is initialised once and never closed: threads of it may still run at exit.
void open_library() {
  static const int opened = mosquitto_lib_init();
  (void)opened;
}

std::string fault(const std::string& what, int code) { return what + mosquitto_strerror(code); }

}  // namespace

// Called on the thread of the library.
struct MqttClient::Callbacks {
  static MqttClient& self(void* object) { return *static_cast<MqttClient*>(object); }

  static void on_connect(::mosquitto*, void* object, int code, int, const mosquitto_property*) {
    MqttClient& client = self(object);
    if (code == 0) {
      client.state_ = MqttState::kOpen;
      client.options_.wake();
      return;
    }
    const bool is_5 = client.spec_.version == MqttVersion::k5;
    client.finish(std::string("refused: ") +
                  (is_5 ? mosquitto_reason_string(code) : mosquitto_connack_string(code)));
  }
  static void on_disconnect(::mosquitto*, void* object, int code, const mosquitto_property*) {
    if (code >= MQTT_RC_UNSPECIFIED)
      self(object).finish(std::string("closed by the server: ") + mosquitto_reason_string(code));
  }
  static void on_publish(::mosquitto*, void* object, int id, int code, const mosquitto_property*) {
    self(object).add({MqttEventKind::kAcknowledged, id, code, {}});
  }
  static void on_unsubscribe(::mosquitto*, void* object, int id) {
    self(object).add({MqttEventKind::kConfirmed, id, 0, {}});
  }
  static void on_message(::mosquitto*, void* object, const mosquitto_message* message) {
    if (message->payloadlen < 0 || static_cast<std::size_t>(message->payloadlen) > kMostBytes)
      return;
    const std::string payload(static_cast<const char*>(message->payload),
                              static_cast<std::size_t>(message->payloadlen));
    self(object).add(
        {MqttEventKind::kReceived, 0, 0, {message->topic, payload, message->qos, message->retain}});
  }
};

MqttClient::MqttClient(const MqttServers& spec, Options options)
    : spec_(spec), options_(std::move(options)) {
  open_library();
  mosquitto_ = mosquitto_new(options_.client_id.c_str(), true, this);
  if (auto wrong = mosquitto_ == nullptr ? "no memory" : prepare()) {
    finish(*std::move(wrong));
    return;
  }
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "mqtt");
    run();
  });
}

MqttClient::~MqttClient() {
  is_ending_ = true;
  if (thread_.joinable()) thread_.join();
  if (mosquitto_ != nullptr) mosquitto_destroy(mosquitto_);
}

std::optional<std::string> MqttClient::prepare() {
  const bool is_5 = spec_.version == MqttVersion::k5;
  mosquitto_int_option(mosquitto_, MOSQ_OPT_PROTOCOL_VERSION,
                       is_5 ? MQTT_PROTOCOL_V5 : MQTT_PROTOCOL_V311);
  mosquitto_int_option(mosquitto_, MOSQ_OPT_SEND_MAXIMUM, kAllInFlight);
  mosquitto_threaded_set(mosquitto_, true);
  mosquitto_connect_v5_callback_set(mosquitto_, Callbacks::on_connect);
  mosquitto_disconnect_v5_callback_set(mosquitto_, Callbacks::on_disconnect);
  mosquitto_publish_v5_callback_set(mosquitto_, Callbacks::on_publish);
  mosquitto_unsubscribe_callback_set(mosquitto_, Callbacks::on_unsubscribe);
  mosquitto_message_callback_set(mosquitto_, Callbacks::on_message);
  if (options_.will) {
    const MqttMessage& will = *options_.will;
    const int done =
        mosquitto_will_set(mosquitto_, will.topic.c_str(), static_cast<int>(will.payload.size()),
                           will.payload.data(), will.qos, will.retain);
    if (done != MOSQ_ERR_SUCCESS) return fault("will " + will.topic + ": ", done);
  }
  if (options_.server.tls) {
    if (!spec_.key.empty()) {
      if (auto safe = check_secret_file(spec_.key, Readers::kOwnerAndGroup); !safe)
        return safe.error();
    }
    const auto file = [](const std::string& path) { return path.empty() ? nullptr : path.c_str(); };
    const int done = mosquitto_tls_set(mosquitto_, file(spec_.authority),
                                       spec_.authority.empty() ? kSystemAuthorities : nullptr,
                                       file(spec_.certificate), file(spec_.key), nullptr);
    if (done != MOSQ_ERR_SUCCESS)
      return fault("TLS: authority, certificate or key cannot be read: ", done);
  }
  if (spec_.password_file.empty()) return std::nullopt;
  const auto password = read_secret_line(spec_.password_file, Readers::kOwnerAndGroup);
  if (!password) return password.error();
  std::string text(password->text());
  const int done = mosquitto_username_pw_set(mosquitto_, spec_.user.c_str(), text.c_str());
  wipe(text);
  if (done != MOSQ_ERR_SUCCESS) return fault("login with " + spec_.password_file + ": ", done);
  return std::nullopt;
}

void MqttClient::run() {
  const MqttServer& server = options_.server;
  const Instant began = steady_now();
  int code = mosquitto_connect_async(mosquitto_, server.host.c_str(), server.port, kKeepAlive);
  while (code == MOSQ_ERR_SUCCESS && !is_ending_) {
    code = mosquitto_loop(mosquitto_, kTurnMs, 1);
    if (state_ == MqttState::kOpening && steady_now() - began > kOpening)
      return finish("no response to the connection");
  }
  finish(mosquitto_strerror(code));
}

// The first reason is kept: later ones are consequences.
void MqttClient::finish(std::string reason) {
  {
    const std::lock_guard lock(mutex_);
    if (reason_.empty()) reason_ = std::move(reason);
  }
  state_ = MqttState::kClosed;
  options_.wake();
}

void MqttClient::add(MqttEvent event) {
  {
    const std::lock_guard lock(mutex_);
    if (event.kind == MqttEventKind::kReceived && ++received_ > kMostReceived) return;
    events_.push_back(std::move(event));
  }
  options_.wake();
}

std::string MqttClient::text_of(int reason) { return mosquitto_reason_string(reason); }

std::string MqttClient::reason() const {
  const std::lock_guard lock(mutex_);
  return reason_;
}

std::vector<MqttEvent> MqttClient::take_events() {
  const std::lock_guard lock(mutex_);
  received_ = 0;
  return std::exchange(events_, {});
}

tl::expected<int, MqttClient::Fault> MqttClient::publish(const MqttMessage& message) {
  int id = 0;
  const int done = mosquitto_publish_v5(
      mosquitto_, &id, message.topic.c_str(), static_cast<int>(message.payload.size()),
      message.payload.data(), message.qos, message.retain, nullptr);
  switch (done) {
    case MOSQ_ERR_SUCCESS: return id;
    case MOSQ_ERR_OVERSIZE_PACKET:
    case MOSQ_ERR_PAYLOAD_SIZE: return tl::make_unexpected(Fault::kTooLarge);
    case MOSQ_ERR_INVAL:
    case MOSQ_ERR_MALFORMED_UTF8: return tl::make_unexpected(Fault::kInvalid);
    default: return tl::make_unexpected(Fault::kNotSent);
  }
}

bool MqttClient::subscribe(const std::string& filter) {
  return mosquitto_subscribe(mosquitto_, nullptr, filter.c_str(), 1) == MOSQ_ERR_SUCCESS;
}

std::optional<int> MqttClient::confirm() {
  int id = 0;
  if (mosquitto_unsubscribe(mosquitto_, &id, kConfirmation) != MOSQ_ERR_SUCCESS)
    return std::nullopt;
  return id;
}

void MqttClient::close(bool publish_will) {
  if (state_ == MqttState::kOpen) {
    mosquitto_disconnect_v5(mosquitto_,
                            publish_will && spec_.version == MqttVersion::k5
                                ? MQTT_RC_DISCONNECT_WITH_WILL_MSG
                                : MQTT_RC_NORMAL_DISCONNECTION,
                            nullptr);
    for (const Instant limit = steady_now() + kLeaving;
         state_ == MqttState::kOpen && steady_now() < limit;)
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  is_ending_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace fieldcast::forward
