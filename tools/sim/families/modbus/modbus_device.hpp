// Simulated Modbus devices: a ModbusUnit with one of three framings.
#pragma once

#include <memory>
#include <string>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

// Each fails for a unit outside 1..247 (TCP: 0..255) or an invalid channel address.
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_rtu_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_ascii_device(
    const DeviceSetup& setup);
[[nodiscard]] tl::expected<std::unique_ptr<SimDevice>, std::string> make_modbus_tcp_device(
    const DeviceSetup& setup);

}  // namespace fieldcast::sim
