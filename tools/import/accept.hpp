// Writes the imported configuration and validates it with the bridge's loader; points that the
// loader rejects are removed until the rest is valid. Pure.
#pragma once

#include <tl/expected.hpp>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Moves each rejected point from `found.buses` to `found.refusals`, with the loader's message.
// Fails with a fault that the user must fix by options (--port, --protocol ..). REQUIRES: arrange()
// was called.
[[nodiscard]] tl::expected<std::vector<WrittenFile>, std::string> write_accepted(
    Found& found, const ImportOptions& options, const std::string& head,
    const Progress& progress = {});

}  // namespace fieldcast::importing
