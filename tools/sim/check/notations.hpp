// Every way in which an address of a protocol can be written: what the bridge accepts, the
// simulated device must accept too, and mean the same item.
#pragma once

#include <string>
#include <vector>

#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

// For each form of the notation one address or more; of a declaration those of its areas and
// records.
[[nodiscard]] std::vector<std::string> notations_of(const Subject& subject);

// The type that an address suggests by itself: a bool for a bit, else an unsigned number as wide as
// the address says, or a text for a declared one.
[[nodiscard]] Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                                        const declared::Declaration* declaration);

}  // namespace fieldcast::sim
