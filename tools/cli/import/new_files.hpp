// Writes several files as one: all of them, whole, or none. Main thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fieldcast::cli {

struct NewFile {
  std::string path;
  std::string text;
};

// Each text goes to PATH.new first, then every file gets its name. Without `replace` a file that is
// there is never touched. The fault is one line; then nothing of ours is left.
[[nodiscard]] std::optional<std::string> write_new_files(const std::vector<NewFile>& files,
                                                         bool replace);

}  // namespace fieldcast::cli
