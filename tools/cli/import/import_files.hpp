// Formats the result of an import as text and as JSON. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::cli {

inline constexpr std::size_t kMovedShown = 20;
[[nodiscard]] std::vector<std::string> import_lines(const importing::Outcome& outcome, bool all,
                                                    const Screen& screen);

[[nodiscard]] std::string import_summary(const importing::Outcome& outcome);

// {"fate", "name", "channel", "at", "type", "why", "file", "line"}; for imported values also
// "scale", "offset", "word_order", "byte_order", "access"
[[nodiscard]] Json fate_json(const importing::PointFate& row);

// Regular files of at most config::kMaxFileBytes, together config::kMaxTotalBytes. The error has
// the file, the fault and the fix. Main thread.
[[nodiscard]] tl::expected<std::vector<importing::InputFile>, std::string> read_inputs(
    const std::vector<std::string>& paths);

struct NewFile {
  std::string path;
  std::string text;
};

// Writes several files as a unit: all of them completely, or none. Main thread.
// Writes to PATH.PID.new first, then renames. Never replaces a file without `replace`. Returns one
// line on failure; then no new file remains.
[[nodiscard]] std::optional<std::string> write_new_files(const std::vector<NewFile>& files,
                                                         bool replace);

}  // namespace fieldcast::cli
