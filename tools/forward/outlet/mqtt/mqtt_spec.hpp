// How a forwarder reaches an MQTT server, and what it publishes as plain MQTT. Plain values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::forward {

struct MqttServer {
  std::string host = "127.0.0.1";
  std::uint16_t port = 1883;
  bool tls = false;
  friend bool operator==(const MqttServer&, const MqttServer&) = default;
};

enum class MqttVersion : std::uint8_t { k311, k5 };

// Tried in turn. Of each section that uses MQTT.
struct MqttServers {
  std::vector<MqttServer> servers{MqttServer{}};
  std::string authority;  // PEM file that signed the server's certificate; empty: the system's
  std::string certificate, key;  // PEM files of this client
  std::string user, password_file;
  bool without_tls = false;  // plain text off the loopback, explicitly configured
  MqttVersion version = MqttVersion::k5;
  std::string client_id;                               // empty: fieldcast-forward-SITE
  Duration acknowledgement = std::chrono::seconds{5};  // then the connection is made again
  friend bool operator==(const MqttServers&, const MqttServers&) = default;
};

struct MqttSpec : MqttServers {
  std::string prefix = "fieldcast";  // first level of all topics
  bool retain = false;               // the server keeps the last value of each channel
  bool discovery = false;            // messages for Home Assistant
  std::string discovery_prefix = "homeassistant";
  friend bool operator==(const MqttSpec&, const MqttSpec&) = default;
};

}  // namespace fieldcast::forward
