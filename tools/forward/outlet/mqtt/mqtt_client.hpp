// One connection to an MQTT server by libmosquitto, from its attempt to its end. A thread runs the
// library and collects events; all other functions belong to one thread.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "tools/forward/outlet/mqtt/mqtt_spec.hpp"

struct mosquitto;

namespace fieldcast::forward {

struct MqttMessage {
  std::string topic, payload;
  int qos = 1;
  bool retain = false;
};

enum class MqttEventKind : std::uint8_t {
  kAcknowledged,  // PUBACK of a message with QoS 1
  kConfirmed,     // the server has processed all that was sent before confirm()
  kReceived,
};

struct MqttEvent {
  MqttEventKind kind = MqttEventKind::kReceived;
  int id = 0;      // of the message or of confirm()
  int reason = 0;  // reason code of MQTT 5; 128 and more: refused
  MqttMessage message;
};

enum class MqttState : std::uint8_t { kOpening, kOpen, kClosed };

class MqttClient {
 public:
  struct Options {
    MqttServer server;
    std::string client_id;
    std::optional<MqttMessage> will;
    std::function<void()> wake;  // called by the thread after each event and change of the state
  };
  // Starts the attempt. Reads the files of the login.
  MqttClient(const MqttServers& spec, Options options);
  // Closes the connection without DISCONNECT, if it is open: the server publishes the will.
  ~MqttClient();
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;

  [[nodiscard]] MqttState state() const { return state_; }
  // Why the connection was closed. REQUIRES: closed.
  [[nodiscard]] std::string reason() const;
  // Of a reason code of MQTT 5.
  [[nodiscard]] static std::string text_of(int reason);

  enum class Fault : std::uint8_t { kTooLarge, kInvalid, kNotSent };
  // Returns the id of the message; a message with QoS 1 has an event with it.
  [[nodiscard]] tl::expected<int, Fault> publish(const MqttMessage& message);
  [[nodiscard]] bool subscribe(const std::string& filter);
  // Requests an event when the server has processed everything before: it responds to an
  // UNSUBSCRIBE in the order of the connection, and the filter has no subscription (MQTT 3.1.1,
  // 3.10.4).
  [[nodiscard]] std::optional<int> confirm();
  // Sends DISCONNECT after all messages, with `publish_will` for MQTT 5 that with its will, and
  // waits at most a second.
  void close(bool publish_will);

  [[nodiscard]] std::vector<MqttEvent> take_events();

 private:
  // Received messages that were not taken yet; further ones are dropped.
  static constexpr std::size_t kMostReceived = 1024;
  static constexpr std::size_t kMostBytes = 64 * 1024;  // of a received message

  struct Callbacks;
  void run();
  [[nodiscard]] std::optional<std::string> prepare();  // returns a fault
  void add(MqttEvent event);
  void finish(std::string reason);

  const MqttServers spec_;
  const Options options_;
  ::mosquitto* mosquitto_ = nullptr;
  std::atomic<MqttState> state_ = MqttState::kOpening;
  std::atomic<bool> is_ending_ = false;

  mutable std::mutex mutex_;  // protects the members below; not held while the library is called
  std::vector<MqttEvent> events_;
  std::size_t received_ = 0;
  std::string reason_;

  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast::forward
