// Parses spreadsheet text: comma, semicolon or tab, quotes, Excel's `sep=;`. Pure. Limits: kMaxRows
// rows, kMaxCells cells each; the rest is dropped and reported.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::importing {

inline constexpr std::size_t kMaxRows = 200'000;
inline constexpr std::size_t kMaxCells = 256;

struct Row {
  unsigned line = 0;  // its first line, from 1
  std::vector<std::string> cells;
  [[nodiscard]] std::string_view cell(std::size_t column) const {
    return column < cells.size() ? std::string_view(cells[column]) : std::string_view();
  }
};

struct Table {
  std::vector<Row> rows;  // without empty rows
  char separator = ',';
};

// The error has the fault and its line.
[[nodiscard]] tl::expected<Table, std::string> read_table(std::string_view text);

// Lower case, letters and digits only: "Eng. Units" becomes "engunits".
[[nodiscard]] std::string column_word(std::string_view title);

}  // namespace fieldcast::importing
