// One bus: its port, protocol, defaults and devices.
#pragma once

#include "config/device.hpp"
#include "config/document.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Faults are noted; with faults the result is whatever could be read.
[[nodiscard]] BusSpec read_bus(const Node& node, Session& session);

}  // namespace fieldcast::config
