// What the titles of register lists mean: a row for each word that a list may have for a column.
#pragma once

#include <optional>
#include <string_view>

#include "tools/import/columns.hpp"

namespace fieldcast::importing {

[[nodiscard]] Columns list_columns(const Row& header);

// From where the numbers in a column of addresses count, by its title; nothing: it does not say.
[[nodiscard]] std::optional<unsigned> first_address_of_title(std::string_view title);

}  // namespace fieldcast::importing
