// Modbus RTU devices "unit-1", … with registers "r0" at holding:100, …; "r3" is read-only.
#pragma once

#include <string>

#include "core/bus/setup/bus_setup.hpp"

namespace fieldcast::test {

inline constexpr AreaIndex kHolding = 2;
inline constexpr ChannelIndex kChannelsOfDevice = 4;

inline BusSpec rtu_bus(int devices) {
  BusSpec bus;
  bus.name = "bus";
  bus.port = SerialPortSpec{"/dev/none", {}};
  for (int d = 1; d <= devices; ++d) {
    DeviceSpec device;
    device.name = "unit-" + std::to_string(d);
    device.protocol = "modbus-rtu";
    device.link.address = static_cast<std::uint16_t>(d);
    for (ChannelIndex c = 0; c < kChannelsOfDevice; ++c) {
      ChannelSpec channel;
      channel.name = "r" + std::to_string(c);
      channel.at = "holding:" + std::to_string(100 + c);
      channel.range = {kHolding, 100 + c, 1};
      channel.access = c == 3 ? Access::kReadOnly : Access::kReadWrite;
      device.channels.push_back(channel);
    }
    bus.devices.push_back(device);
  }
  return bus;
}

inline Reply items(Bytes bytes) { return {{Cause::kNone, 0, std::move(bytes)}}; }

}  // namespace fieldcast::test
