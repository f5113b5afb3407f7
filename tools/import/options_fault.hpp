// Validates options separately, so that their faults are not reported for a list. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// "--baud: baud 115000 is no rate of serial ports; allowed: ..". Empty if the options are valid.
[[nodiscard]] std::optional<std::string> fault_of_options(const ImportOptions& options);

}  // namespace fieldcast::importing
