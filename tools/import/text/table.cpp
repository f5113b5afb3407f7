#include "tools/import/text/table.hpp"

#include <algorithm>
#include <array>

namespace fieldcast::importing {

namespace {

// The most frequent one outside quotes in the first lines.
char separator_of(std::string_view text) {
  constexpr std::array kSeparators{';', '\t', ','};
  std::array<std::size_t, 3> counts{};
  bool quoted = false;
  unsigned lines = 0;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (c == '\n' && ++lines == 5) break;
    for (std::size_t i = 0; i < kSeparators.size() && !quoted; ++i)
      counts[i] += c == kSeparators[i];
  }
  // A semicolon or tab in the title row has priority, because commas may be decimal commas.
  const std::string_view title = text.substr(0, text.find('\n'));
  for (std::size_t i = 0; i < 2; ++i) {
    if (title.find(kSeparators[i]) != std::string_view::npos && counts[i] >= lines)
      return kSeparators[i];
  }
  return kSeparators[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
}

class TableReader {
 public:
  explicit TableReader(std::string_view text) : text_(text) {
    if (lower(text.substr(0, 4)) == "sep=" && text.size() > 5 && text[5] == '\n') {
      table_.separator = text[4];
      at_ = 6;
      line_ = 2;
    } else {
      table_.separator = separator_of(text);
    }
  }

  Result<Table> read() {
    while (at_ < text_.size()) {
      Row row{.line = line_, .cells = {}};
      if (!read_row(row)) return tl::unexpected(std::move(fault_));
      while (!row.cells.empty() && row.cells.back().empty()) row.cells.pop_back();
      if (row.cells.empty()) continue;
      if (table_.rows.size() == kMaxRows)
        return refused("more than {} rows; split the list", kMaxRows);
      table_.rows.push_back(std::move(row));
    }
    return std::move(table_);
  }

 private:
  bool read_row(Row& row) {
    for (;;) {
      std::string cell;
      if (at_ < text_.size() && text_[at_] == '"') {
        if (!read_quoted(cell)) return false;
      }
      const std::size_t end =
          std::min(text_.find_first_of(std::string{table_.separator, '\n'}, at_), text_.size());
      cell += text_.substr(at_, end - at_);
      at_ = end;
      if (row.cells.size() == kMaxCells) {
        fault_ = fmt::format("line {}: more than {} cells in a row", row.line, kMaxCells);
        return false;
      }
      row.cells.emplace_back(trimmed(cell));
      if (at_ == text_.size()) return true;
      if (text_[at_++] == '\n') {
        ++line_;
        return true;
      }
    }
  }

  bool read_quoted(std::string& cell) {
    const unsigned begin = line_;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (at_ + 1 == text_.size() || text_[at_ + 1] != '"') {
          ++at_;
          return true;
        }
        ++at_;
      }
      if (text_[at_] == '\n') ++line_;
      cell += text_[at_];
    }
    fault_ = fmt::format("line {}: a quoted cell has no end", begin);
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
  Table table_;
  std::string fault_;
};

}  // namespace

Result<Table> read_table(std::string_view text) { return TableReader(text).read(); }

std::string column_word(std::string_view title) {
  std::string word;
  for (const char c : lower(title)) {
    if ((c >= 'a' && c <= 'z') || is_digit(c) || static_cast<unsigned char>(c) >= 0x80) word += c;
  }
  return word;
}

Columns::Columns(const Row& header, std::span<const Words<Field>> names,
                 std::string (*word_of)(std::string_view))
    : titles_(header.cells) {
  for (std::size_t i = 0; i < header.cells.size(); ++i) {
    const std::string word = word_of(header.cells[i]);
    const auto found = std::ranges::find_if(
        names, [&](const Words<Field>& name) { return is_one_of(word, name.words); });
    meant_.push_back(found == names.end() ? std::nullopt : std::optional(found->value));
    if (!meant_.back() || has(found->value)) continue;
    set(found->value, i);
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
