#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/importer.hpp"

namespace fieldcast::cli {

// Regular files of at most config::kMaxFileBytes, together config::kMaxTotalBytes. The error has
// the file, the fault and the fix. Main thread.
[[nodiscard]] tl::expected<std::vector<importing::InputFile>, std::string> read_inputs(
    const std::vector<std::string>& paths);

}  // namespace fieldcast::cli
