#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

// Totals, heads, and the channels sorted by name. Rows that do not fit are counted below. The lag
// remark is last. `now` and `utc` are the same moment.
[[nodiscard]] std::vector<std::string> watch_lines(const WatchModel& model, Instant now,
                                                   UtcTime utc, const Screen& screen);

// This station is too slow: {"event":"too_slow","blocks_missed","last_values_requests"}.
[[nodiscard]] Json lag_json(const Station::BlockCounters& counters);

}  // namespace fieldcast::cli
