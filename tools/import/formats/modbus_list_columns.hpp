// What the titles of register lists mean: a row for each word that a list may have for a column.
#pragma once

#include <span>

#include "tools/import/columns.hpp"

namespace fieldcast::importing {

[[nodiscard]] std::span<const ColumnName> list_columns();

}  // namespace fieldcast::importing
