// The live table of `fieldcast watch`: model -> lines. Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// A title with the totals, the table's head, one line for each channel in the order of their names;
// what the screen has no room for is counted in the last line. `now` and `utc` are the same moment.
[[nodiscard]] std::vector<std::string> watch_lines(const WatchModel& model, Instant now,
                                                   UtcTime utc, const Screen& screen);

}  // namespace fieldcast::cli
