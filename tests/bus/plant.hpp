// Plants for the simulation tests: buses of simulated devices with commands and values.
//
// Runs on the thread of the test. Throws std::runtime_error if the configuration has an error.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "config/loader/loader.hpp"
#include "tests/bus/virtual_bus.hpp"

namespace fieldcast::test {

// Registers are at every second address and writable. fill() writes value_of() each channel.
inline BusSpec plant(int devices, int registers, const std::string& defaults) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200, format: "
      "8E1 }\n    protocol: "
      "modbus-rtu\n    defaults: { " +
      defaults + " }\n    devices:\n";
  for (int d = 1; d <= devices; ++d) {
    text += "      - name: unit-" + std::to_string(d) + "\n        address: " + std::to_string(d) +
            "\n        channels:\n";
    for (int r = 0; r < registers; ++r)
      text += "          - { name: r" + std::to_string(r) +
              ", at: \"holding:" + std::to_string(100 + 2 * r) +
              "\", type: uint16, access: read-write }\n";
  }
  const auto loaded = config::load_text(text, "plant.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return loaded->buses.front();
}

inline BusSpec dtc_plant(const std::string& defaults) {
  std::string text =
      "bridge: test\nbuses:\n  - name: bus\n    port: { serial: /dev/none, baud: 19200, format: "
      "8N1 }\n    protocol: dtc\n    "
      "defaults: { " +
      defaults + " }\n    devices:\n      - name: unit\n        address: 1\n        channels:\n";
  for (int i = 0; i < 40; ++i) {
    const std::string at = i % 3 == 0 ? "int16" : i % 3 == 1 ? "int32" : "float64";
    const std::string type = i % 3 == 0 ? "uint16" : i % 3 == 1 ? "uint32" : "uint64";
    text += "          - { name: v" + std::to_string(i) + ", at: \"" + at + ":" +
            std::to_string(100 + 37 * i) + "\", type: " + type + ", access: read-write }\n";
  }
  const auto loaded = config::load_text(text, "plant.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  return loaded->buses.front();
}

inline std::uint64_t value_of(ChannelIndex channel) {
  return (channel * 2654435761u) >> 16 & 0xFFFF;
}

// The channel index counts through all devices in their order.
inline Command write_of(const BusSpec& spec, ChannelIndex channel, std::uint64_t value) {
  Command command;
  for (const DeviceSpec& device : spec.devices) {
    if (channel < device.channels.size()) {
      command.device = device.name;
      command.target = ChannelTarget{device.channels[channel].name};
      break;
    }
    channel -= static_cast<ChannelIndex>(device.channels.size());
  }
  command.values = {Value{value}};
  return command;
}

// Writes a different value to each register, so a value of another register is detected.
inline void fill(VirtualBus& bus, const BusSpec& spec) {
  for (ChannelIndex c = 0; c < bus.channels().size(); ++c) {
    bus.command(write_of(spec, c, value_of(c)));
    bus.run_until(bus.now() + std::chrono::milliseconds{500});
  }
  for (const auto& [id, results] : bus.results())
    ASSERT_EQ(results.front().state, CommandState::kDone) << results.front().reason;
  bus.run_until(bus.now() + std::chrono::seconds{5});
  bus.judge = [](ChannelIndex channel, const Value& value) {
    if (std::get<std::uint64_t>(value) == value_of(channel)) return std::string{};
    return "channel " + std::to_string(channel) + " shows " + to_text(value) +
           ", its register holds " + std::to_string(value_of(channel));
  };
}

}  // namespace fieldcast::test
