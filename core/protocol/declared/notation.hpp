// `holding:100`, `holding:100.5`, or a place of a record by its name. Pure.
#pragma once

#include <string_view>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::declared {

[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(
    const Declaration& declaration, std::string_view at);

}  // namespace fieldcast::declared
