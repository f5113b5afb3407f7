// Simulated Modbus devices: memory and functions of a ModbusUnit under one of the three framings.
#pragma once

#include <memory>
#include <string>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

// Refuses, with a text for people, a unit outside 1..247 (0..255 on TCP) and a channel whose
// address is no Modbus address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_rtu_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_ascii_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_tcp_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
