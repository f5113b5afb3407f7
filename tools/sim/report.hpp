#pragma once

#include <memory>
#include <span>
#include <string>

#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::sim {

// Location of a bus as one JSON line without line end.
[[nodiscard]] std::string location_line(const BusSpec& bus, const std::string& location);

[[nodiscard]] std::string report_of(std::span<const std::unique_ptr<SimBus>> buses,
                                    Duration running);

// Replaces the file atomically. Returns false on failure; see errno.
[[nodiscard]] bool write_report(const std::string& path, const std::string& report);

}  // namespace fieldcast::sim
