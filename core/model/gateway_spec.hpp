// The gateway of a bus: clients that read and write its devices by Modbus TCP. Plain values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {

struct GatewaySpec {
  ListenSpec listen;
  bool writes = false;  // only to devices with allow: raw-write
  bool verify = false;  // reads each write back
  // Device by unit of the request; empty: each device at its address.
  std::map<std::uint8_t, std::string> units;
  std::vector<std::string> clients;  // addresses and networks, "10.0.0.0/8"; empty: the loopback
  // A stored response of the device at most this old is returned without a request to the device.
  Duration max_age = std::chrono::milliseconds{500};
  double share = 0;  // of the wire, which clients get even if refreshes are missed; 0 to 0.5
  Duration timeout = std::chrono::seconds{1};  // until a request is refused as busy
  Duration idle = std::chrono::minutes{1};     // until a silent client is disconnected
  std::uint16_t connections = 32;
  friend bool operator==(const GatewaySpec&, const GatewaySpec&) = default;
};

}  // namespace fieldcast
