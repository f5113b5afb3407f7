#pragma once

#include <string>

#include "tests/tools/sim/listen.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim::test {

inline DeviceSetup device_setup(std::uint16_t address) {
  DeviceSetup setup;
  setup.spec.name = "plc";
  setup.spec.link.address = address;
  setup.line = kLine;
  setup.start = kBegin;
  return setup;
}

inline ChannelSpec channel(const std::string& name, const std::string& at, ValueType type) {
  ChannelSpec spec;
  spec.name = name;
  spec.at = at;
  spec.encoding.type = type;
  return spec;
}

inline Bytes bytes(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace fieldcast::sim::test
