// One device of a bus: its protocol and address, its template, its channels.
#pragma once

#include <string>

#include "config/cascade.hpp"
#include "config/library.hpp"
#include "config/unique_names.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// What one load shares.
struct Session {
  FaultList& faults;
  Library& library;
  std::size_t channels = 0;  // so far, of the whole bridge
};

struct DeviceContext {
  std::string protocol;         // of the bus; empty when it names none, or an unknown one
  bool protocol_named = false;  // rightly or wrongly
  Place protocol_place;
  DeviceDefaults defaults;
  const PortSpec& port;
  UniqueNames& addresses;  // of the bus, each with its protocol
};

// Faults are noted; with faults the result is whatever could be read.
[[nodiscard]] DeviceSpec read_device(const Node& node, const DeviceContext& context, Session& session);

// The protocol's row, or nothing and a fault with the nearest name.
const ProtocolEntry* read_protocol(const Node& node, std::string_view key, FaultList& faults);

}  // namespace fieldcast::config
