// Writes several files as a unit: all of them completely, or none. Main thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fieldcast::cli {

struct NewFile {
  std::string path;
  std::string text;
};

// Writes to PATH.new first, then renames. Never replaces a file without `replace`. Returns one line
// on failure; then no new file remains.
[[nodiscard]] std::optional<std::string> write_new_files(const std::vector<NewFile>& files,
                                                         bool replace);

}  // namespace fieldcast::cli
