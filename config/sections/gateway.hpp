#pragma once

#include <optional>

#include "config/document/map_reader.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast::config {

[[nodiscard]] const Rows<GatewaySpec>& gateway_rows();
[[nodiscard]] const Rows<GatewayRow>& gateway_row_rows();

// gateway: { listen, access, verify, units, map, clients, max-age, share, timeout, idle,
// connections }
// REQUIRES: the devices of the bus were read.
void read_gateway(MapReader& bus, BusSpec& spec);

}  // namespace fieldcast::config
