#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/model/bus_simulation.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

// Totals, misses by cause, and the channels sorted by misses, then by tightness.
[[nodiscard]] std::vector<std::string> simulation_lines(const BusSimulation& simulation,
                                                        const Screen& screen);

// {"bus", "simulated", "seed", "refreshes", "missed", "causes": {..}, "failures": {..},
// "exchanges", "stretch", "planned_load", "predicted_load", "measured_load", "channels":
// [{"device", "channel", "refresh", "refreshes", "missed", "last_cause", "worst_gap",
// "predicted_gap"}], "devices": [{"device", "state", "exchanges", "failures", "retries",
// "answer_time", "answer_spread"}], "fingerprint"}; times in nanoseconds, channels as in the text.
[[nodiscard]] Json simulation_json(const BusSimulation& simulation);

}  // namespace fieldcast::cli
