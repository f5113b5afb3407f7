// Formats the schedule of a bus (core/plan/read_plan.hpp) as JSON. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "core/plan/read_plan.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// {"load", "stretch", "slot", "hyperperiod", "groups": [{"device", "list", "period", "phase",
// "slack", "load", "points": [{"area", "first", "count", "channels": ["name"], "period", "phase",
// "worst_gap", "stretch"}]}]}.
//
// Times are in nanoseconds, loads are shares of the wire. `slot` and `hyperperiod` are null in a
// plan without a timetable; `period`, `phase`, `slack` and `worst_gap` are null without a period.
[[nodiscard]] Json read_plan_json(const PlanReport& plan);
[[nodiscard]] Json read_plan_json(const BusPlan& plan);

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
