// Calculates consecutive addresses in the PLC's notation. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// "holding:102" for "holding:100" and 2. Empty at the end of the area, or if the notation counts
// differently (bits of a word, octal numbers).
[[nodiscard]] std::optional<std::string> address_behind(const Protocol& protocol,
                                                        std::string_view at, std::uint32_t items);

// At least 1.
[[nodiscard]] std::uint32_t values_in_request(const Protocol& protocol, const ParsedAddress& at,
                                              std::uint32_t value_items);

}  // namespace fieldcast::cli
