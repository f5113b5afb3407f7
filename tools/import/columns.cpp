#include "tools/import/columns.hpp"

#include <algorithm>

namespace fieldcast::importing {

Columns::Columns(const Row& header, std::span<const ColumnName> names) {
  for (std::size_t i = 0; i < header.cells.size(); ++i) {
    const std::string word = column_word(header.cells[i]);
    const auto found = std::ranges::find(names, word, &ColumnName::word);
    const bool free =
        found != names.end() && !indexes_[static_cast<std::size_t>(found->field)].has_value();
    if (free) {
      indexes_[static_cast<std::size_t>(found->field)] = i;
      ++known_;
    } else if (!header.cells[i].empty()) {
      ignored_.push_back(header.cells[i]);
    }
  }
}

std::string_view Columns::cell(const Row& row, Field field) const {
  const auto index = index_of(field);
  return index ? row.cell(*index) : std::string_view();
}

}  // namespace fieldcast::importing
