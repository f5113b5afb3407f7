// The live table of `fieldcast watch`: model -> lines. Pure.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// A title with the totals, the table's head, one line for each channel in the order of their names;
// what the screen has no room for is counted below them. Last comes the lag remark, if there is
// one. `now` and `utc` are the same moment.
[[nodiscard]] std::vector<std::string> watch_lines(const WatchModel& model, Instant now,
                                                   UtcTime utc, const Screen& screen);

// The event that this station is too slow, with the totals so far:
// {"event":"too_slow","blocks_missed","last_values_requests"}. Samples have no "event".
[[nodiscard]] Json lag_json(const Station::BlockCounters& counters);

}  // namespace fieldcast::cli
