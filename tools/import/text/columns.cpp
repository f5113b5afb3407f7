#include "tools/import/text/columns.hpp"

#include <algorithm>

namespace fieldcast::importing {

Columns::Columns(const Row& header, std::span<const ColumnName> names,
                 std::string (*word_of)(std::string_view))
    : titles_(header.cells) {
  for (std::size_t i = 0; i < header.cells.size(); ++i) {
    const std::string word = word_of(header.cells[i]);
    const auto found = std::ranges::find(names, word, &ColumnName::word);
    meant_.push_back(found == names.end() ? std::nullopt : std::optional(found->field));
    if (!meant_.back() || has(found->field)) continue;
    indexes_[static_cast<std::size_t>(found->field)] = i;
    ++known_;
  }
}

std::vector<std::size_t> Columns::others(Field field) const {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < meant_.size(); ++i) {
    if (meant_[i] == field && index_of(field) != i) columns.push_back(i);
  }
  return columns;
}

void Columns::set(Field field, std::optional<std::size_t> column) {
  indexes_[static_cast<std::size_t>(field)] = column;
}

std::vector<std::string> Columns::ignored() const {
  std::vector<std::string> titles;
  for (std::size_t i = 0; i < titles_.size(); ++i) {
    if (!titles_[i].empty() && std::ranges::find(indexes_, i) == indexes_.end())
      titles.push_back(titles_[i]);
  }
  return titles;
}

std::string_view Columns::cell(const Row& row, Field field) const {
  const auto index = index_of(field);
  return index ? row.cell(*index) : std::string_view();
}

}  // namespace fieldcast::importing
