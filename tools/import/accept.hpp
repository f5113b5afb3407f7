// Writes what was found and lets the loader of the bridge read it, until nothing is wrong with it.
// Pure.
#pragma once

#include <tl/expected.hpp>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// Points that the loader refuses move from `found.buses` to `found.refusals`, with its words. The
// error: something else is wrong, which the user has to mend (--port, --protocol ..).
// REQUIRES: arranged.
[[nodiscard]] tl::expected<std::vector<WrittenFile>, std::string> write_accepted(
    Found& found, const ImportOptions& options, const std::string& head,
    const Progress& progress = {});

}  // namespace fieldcast::importing
