// A simulated S7 CPU with ISO-on-TCP (RFC 1006), from the specification only. Each connection
// begins with a connect TPDU to the rack and slot of the CPU, or to its TSAP; others are refused.
// Messages before it, and a frame that is not ISO-on-TCP, end the connection.
#pragma once

#include <memory>

#include "tools/sim/device/item_memory.hpp"
#include "tools/sim/families/s7_unit.hpp"

namespace fieldcast::sim {

class S7TcpDevice : public MemoryDevice {
 public:
  // `named`: the TSAP is that of an option; otherwise it is the place of the CPU.
  S7TcpDevice(const DeviceSetup& setup, std::span<const S7Area> areas, std::uint16_t tsap,
              bool named);

  [[nodiscard]] std::unique_ptr<Receiver> open_receiver() override;

 private:
  class Connection;

  const std::uint16_t tsap_;
  const bool named_;
  S7Unit unit_;
};

// Fails for a slot outside 0..31 or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_s7_tcp_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
