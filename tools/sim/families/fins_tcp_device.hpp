// A simulated Omron PLC at its FINS/TCP port, from the specification only (W421, 7-4). Each
// connection gets a node with its first frame. A second greeting is refused; a message before the
// greeting, and a frame that is not FINS, end the connection. With the option `client-node`, its
// FINS/UDP port: each datagram is a message (W421, 6-2).
#pragma once

#include <memory>

#include "tools/sim/device/item_memory.hpp"
#include "tools/sim/families/fins_unit.hpp"

namespace fieldcast::sim {

class FinsTcpDevice : public MemoryDevice {
 public:
  static constexpr std::size_t kMostMessage = 2012;  // bytes

  explicit FinsTcpDevice(const DeviceSetup& setup);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

 private:
  class Connection;
  class Datagrams;

  const std::uint8_t node_;
  const bool has_port_;  // the PLC of the connection; others are behind it
  const bool datagrams_;
  const LineFormat line_;
  FinsUnit fins_;
};

// Fails for a node outside 0..254 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_fins_tcp_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
