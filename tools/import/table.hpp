// A list as spreadsheets save it: cells by comma, semicolon or tab, with quotes, and Excel's habits
// (`sep=;`, empty cells at the end of rows, blank rows). Pure.
//
// Bounds: kMaxRows rows, kMaxCells cells in each; what is beyond is left out and told.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::importing {

inline constexpr std::size_t kMaxRows = 200'000;
inline constexpr std::size_t kMaxCells = 256;

struct Row {
  unsigned line = 0;  // where it begins, from 1
  std::vector<std::string> cells;
  // The text of a cell; empty behind the last one.
  [[nodiscard]] std::string_view cell(std::size_t column) const {
    return column < cells.size() ? std::string_view(cells[column]) : std::string_view();
  }
};

struct Table {
  std::vector<Row> rows;  // those that hold anything
  char separator = ',';
};

// The error says what is wrong and in which line.
[[nodiscard]] tl::expected<Table, std::string> read_table(std::string_view text);

// Lower case, letters and digits only: "Eng. Units" becomes "engunits".
[[nodiscard]] std::string column_word(std::string_view title);

}  // namespace fieldcast::importing
