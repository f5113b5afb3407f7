// The files that `fieldcast import` is given, read whole. Main thread.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/importer.hpp"

namespace fieldcast::cli {

// Regular files of at most config::kMaxFileBytes, together config::kMaxTotalBytes. The error names
// the file, what is wrong with it and what to do.
[[nodiscard]] tl::expected<std::vector<importing::InputFile>, std::string> read_inputs(
    const std::vector<std::string>& paths);

}  // namespace fieldcast::cli
