#pragma once

#include "config/channel/channel_keys.hpp"
#include "config/declaration/declaration.hpp"
#include "config/document/document.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

struct DeviceContext {
  ProtocolChoice protocol;      // of the bus; unknown if it has none, or an invalid one
  bool protocol_named = false;  // the bus has the key, valid or not
  Position protocol_position;
  DeviceDefaults defaults;
  const PortSpec& port;
  UniqueNames& addresses;  // of the bus, each with its protocol
};

// Adds faults; with faults the result is incomplete.
[[nodiscard]] DeviceSpec read_device(const Node& node, const DeviceContext& context,
                                     LoadState& state);

}  // namespace fieldcast::config
