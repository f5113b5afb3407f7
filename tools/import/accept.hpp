// Writes the configuration and validates it with the bridge's loader. Pure.
#pragma once

#include <tl/expected.hpp>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Moves each rejected point from `found.buses` to `found.refusals`, with the loader's message,
// until the rest is valid. Fails if the user must fix an option. REQUIRES: arrange() was called.
[[nodiscard]] tl::expected<std::vector<WrittenFile>, std::string> write_accepted(
    Found& found, const ImportOptions& options, const std::string& head,
    const Progress& progress = {});

}  // namespace fieldcast::importing
