// Formats the schedule of a bus (core/plan/read_plan.hpp) as JSON. Pure functions.
#pragma once

#include "core/base/json.hpp"
#include "core/plan/read_plan.hpp"
#include "tools/cli/model/bus_plan.hpp"

namespace fieldcast::cli {

// {"load", "stretch", "slot", "hyperperiod", "groups": [{"device", "list", "period", "phase",
// "slack", "load", "points": [{"area", "first", "count", "channels": ["name"], "period", "phase",
// "worst_gap", "stretch"}]}]}.
//
// Times are in nanoseconds, loads are shares of the wire. `slot` and `hyperperiod` are null in a
// plan without a timetable; `period`, `phase`, `slack` and `worst_gap` are null without a period.
[[nodiscard]] Json read_plan_json(const PlanReport& plan);
[[nodiscard]] Json read_plan_json(const BusPlan& plan);

}  // namespace fieldcast::cli
