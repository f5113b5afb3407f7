// Formats the plan of a bus as text and JSON. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

using fieldcast::advice;

// The verdict, the channels (tightest first), the blocks (most frequent first), and the advice.
[[nodiscard]] std::vector<std::string> plan_lines(const BusPlan& plan, const Screen& screen);

// {"bus", "feasible", "load", "planned_load", "least_load", "share_of_possible", "stretch",
// "horizon", "reads", "missed", "answer_time", "channels": [{"device", "channel", "refresh",
// "worst_gap", "reads"}], "blocks": [{"device", "ranges": [{"area", "first", "count"}], "points",
// "cost", "per_second"}], "plan": read_plan_json(), "advice": [..]}; times in nanoseconds, tightest
// channels first.
[[nodiscard]] Json plan_json(const BusPlan& plan);

}  // namespace fieldcast::cli
