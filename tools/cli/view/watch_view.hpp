// Formats the live table of `fieldcast watch`. Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/view/json.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// A title with totals, the table's head, and one line for each channel sorted by name. Rows that do
// not fit are counted below. The lag remark, if any, is last. `now` and `utc` are the same moment.
[[nodiscard]] std::vector<std::string> watch_lines(const WatchModel& model, Instant now,
                                                   UtcTime utc, const Screen& screen);

// The event that this station is too slow, with totals:
// {"event":"too_slow","blocks_missed","last_values_requests"}. Samples have no "event".
[[nodiscard]] Json lag_json(const Station::BlockCounters& counters);

}  // namespace fieldcast::cli
