// One device of a bus: its protocol and address, its template, its channels.
#pragma once

#include <string>

#include "config/cascade.hpp"
#include "config/protocol_choice.hpp"
#include "config/unique_names.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

struct DeviceContext {
  ProtocolChoice protocol;      // of the bus; unknown when it names none, or a wrong one
  bool protocol_named = false;  // rightly or wrongly
  Position protocol_position;
  DeviceDefaults defaults;
  const PortSpec& port;
  UniqueNames& addresses;  // of the bus, each with its protocol
};

// Faults are noted; with faults the result is whatever could be read.
[[nodiscard]] DeviceSpec read_device(const Node& node, const DeviceContext& context,
                                     LoadState& state);

}  // namespace fieldcast::config
