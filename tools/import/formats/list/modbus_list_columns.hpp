// Column titles of register lists.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/text/table.hpp"

namespace fieldcast::importing {

[[nodiscard]] Columns list_columns(const Row& header);

// First number of the addresses as given in the title; empty if it is not.
[[nodiscard]] std::optional<unsigned> first_address_of_title(std::string_view title);

}  // namespace fieldcast::importing
