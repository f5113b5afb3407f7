// What the user said by options, checked by itself: a slip there is no fault of a list. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

// "--baud: baud 115000 is no rate of serial ports; allowed: ..". Nothing: they are fine.
[[nodiscard]] std::optional<std::string> fault_of_options(const ImportOptions& options);

}  // namespace fieldcast::importing
