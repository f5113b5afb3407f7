// A bus's plan for people and as JSON. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/model/bus_plan.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// What would make an infeasible plan feasible, one sentence for each way; empty when it is
// feasible.
[[nodiscard]] std::vector<std::string> advice(const BusPlan& plan);

// The verdict, the channels with the tightest first, the blocks with the most frequent first, and
// the advice.
[[nodiscard]] std::vector<std::string> plan_lines(const BusPlan& plan, const Screen& screen);

// {"bus", "feasible", "load", "planned_load", "stretch", "horizon", "reads", "missed",
// "answer_time", "channels": [{"device", "channel", "refresh", "worst_gap", "reads"}], "blocks":
// [{"device", "ranges": [{"area", "first", "count"}], "points", "cost", "per_second"}], "plan":
// read_plan_json(), "advice": [..]}; times in nanoseconds, channels with the tightest first.
[[nodiscard]] Json plan_json(const BusPlan& plan);

}  // namespace fieldcast::cli
