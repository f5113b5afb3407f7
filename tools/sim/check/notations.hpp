// All notations of an address. The simulated device must accept what the bridge accepts.
#pragma once

#include <string>
#include <vector>

#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

// Returns at least one address of each form; for a declaration, of its areas and records.
[[nodiscard]] std::vector<std::string> notations_of(const Subject& subject);

// Default type: bool for a bit, an unsigned number of its width, or a declared text.
[[nodiscard]] Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                                        const declared::Declaration* declaration);

}  // namespace fieldcast::sim
