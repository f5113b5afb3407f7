// A configured bus with its devices and all defaults. Plain values, made by the loader.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/channel_list.hpp"
#include "core/model/gateway_spec.hpp"
#include "core/model/planner_choice.hpp"
#include "core/model/port_spec.hpp"
#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct DeviceSpec {
  std::string name;
  std::string protocol;                     // "modbus-rtu", or the name of a declaration
  declared::SharedDeclaration declaration;  // of a declared protocol
  DeviceLink link;                          // address and protocol options
  // Time from the end of the request to the first byte of a response.
  Duration timeout = std::chrono::milliseconds{200};
  unsigned retries = 1;         // 0..10 more tries of an exchange
  Duration pause{};             // rest after each exchange with this device
  std::uint16_t max_block = 0;  // items in one read; 0: the protocol's limit
  // Unwanted items that a read may bridge; empty: as many as save time.
  std::optional<std::uint16_t> max_gap;
  bool allow_raw_read = false;  // commands to addresses
  bool allow_raw_write = false;
  // Device number for engineers; empty if the device is not programmed through the bridge.
  std::string number;
  ChannelList channels;
  friend bool operator==(const DeviceSpec&, const DeviceSpec&) = default;
};

// When a file is full, the next begins and the oldest is deleted.
struct CaptureSpec {
  std::string folder;
  std::uint64_t file_bytes = 10'000'000;
  std::uint32_t files = 10;
  bool only_sessions = false;  // programming sessions alone
  friend bool operator==(const CaptureSpec&, const CaptureSpec&) = default;
};

struct BusSpec {
  std::string name;
  PortSpec port;
  SilenceRule silence;  // between a response and the next request
  // Silence within a response that ends it, in addition to its wire time.
  Duration gap_allowance = std::chrono::milliseconds{20};
  std::optional<bool> echo;  // the line echoes sent bytes; empty: detected
  Planner planner = Planner::kCyclic;
  // Maximum number of exchanges at a time. More than 1 only over TCP, if all devices have the same
  // protocol and it has ProtocolEntry::first_frame.
  unsigned in_flight = 1;
  std::vector<DeviceSpec> devices;
  std::optional<CaptureSpec> capture;  // empty: captured only on request
  std::optional<GatewaySpec> gateway;  // empty: no client can connect
  // A reload restarts only buses that differ in more than their capture.
  friend bool operator==(const BusSpec&, const BusSpec&) = default;
};

// Creates the protocol of a device, built-in or declared. `line`: of the bus, for wire times. Fails
// if it is unknown, or rejects the address or an option, which the loader has checked. Pure.
[[nodiscard]] tl::expected<std::unique_ptr<Protocol>, OptionFault> make_protocol(
    const DeviceSpec& device, const LineFormat& line);

}  // namespace fieldcast
