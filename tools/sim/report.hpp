// What the plant did, as JSON, for people and for tests.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::sim {

// Where a bus of the plant is, as one JSON line without its end.
[[nodiscard]] std::string location_line(const BusSpec& bus, const std::string& location);

[[nodiscard]] std::string report_of(std::span<const std::unique_ptr<SimBus>> buses,
                                    Duration running);

// Replaces the file in one step, so that a reader never sees half of it. False: errno says why.
[[nodiscard]] bool write_report(const std::string& path, const std::string& report);

}  // namespace fieldcast::sim
