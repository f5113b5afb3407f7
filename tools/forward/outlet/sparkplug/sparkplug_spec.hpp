// How a forwarder appears as an edge node of Sparkplug B. A plain value.
#pragma once

#include <cstdint>
#include <string>

#include "tools/forward/outlet/mqtt/mqtt_spec.hpp"

namespace fieldcast::forward {

struct SparkplugSpec : MqttServers {
  std::string group = "fieldcast";
  std::string edge_node;     // empty: the name of the site
  std::string primary_host;  // records wait while this host is offline; empty: they never wait
  std::uint32_t qos = 0;     // of messages with data
  std::string command_user;  // as whom commands of hosts are carried out; empty: they are refused
  friend bool operator==(const SparkplugSpec&, const SparkplugSpec&) = default;
};

}  // namespace fieldcast::forward
