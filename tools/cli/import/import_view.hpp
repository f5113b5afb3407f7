// Formats the result of an import as text and as JSON. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/text/text_table.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::cli {

// Number of unchanged values shown, unless all are requested.
inline constexpr std::size_t kMovedShown = 20;
[[nodiscard]] std::vector<std::string> import_lines(const importing::Outcome& outcome, bool all,
                                                    const Screen& screen);

// "12 moved, 3 moved with a change, 1 cannot be moved"
[[nodiscard]] std::string import_summary(const importing::Outcome& outcome);

// {"fate", "name", "channel", "at", "type", "why", "file", "line"}; for imported values also
// "scale", "offset", "word_order", "byte_order", "access"
[[nodiscard]] Json fate_json(const importing::PointFate& row);

}  // namespace fieldcast::cli
