// The gateway of a bus: clients that read and write its devices by Modbus TCP. Plain values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {

// Coils or registers of a Modbus unit that show consecutive values of a device. A wider value
// occupies several registers, the first of them with its highest bits.
struct GatewayRow {
  bool bits = false;  // coils and discrete inputs; otherwise holding and input registers
  std::uint16_t first = 0;
  std::uint32_t count = 1;              // of values
  ValueType type = ValueType::kUint16;  // kBool with `bits`
  std::string at;                       // of the first value, in the notation of the device

  [[nodiscard]] std::uint32_t width() const {  // coils or registers of one value
    return bits ? 1 : item_count({.type = type}, 16);
  }
  [[nodiscard]] std::uint32_t end() const { return first + count * width(); }
  friend bool operator==(const GatewayRow&, const GatewayRow&) = default;
};

struct GatewaySpec {
  ListenSpec listen;
  bool writes = false;  // only to devices with allow: raw-write
  bool verify = false;  // reads each write back
  // Device by unit of the request; empty: each device at its address.
  std::map<std::uint8_t, std::string> units;
  // By device; those without rows have the addresses of their own Modbus.
  std::map<std::string, std::vector<GatewayRow>> rows;
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
