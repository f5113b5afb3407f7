// Tables for terminals: column widths follow the longest cell, colours follow the role. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::cli {

enum class Tone : unsigned char { kPlain, kFaint, kGood, kWarning, kBad, kTitle };
enum class Align : unsigned char { kLeft, kRight };

struct Cell {
  std::string text;
  Tone tone = Tone::kPlain;
};

// Size of a terminal; 0: no limit.
struct Screen {
  std::size_t columns = 0;
  std::size_t rows = 0;
  bool colour = false;
};

// Columns in a terminal; counts each code point as one column.
[[nodiscard]] std::size_t display_width(std::string_view utf8);

// Escapes control characters of untrusted text (core/base/printable.hpp).
[[nodiscard]] std::string printable(std::string_view text);

[[nodiscard]] std::string clip(std::string_view utf8, std::size_t columns);

[[nodiscard]] std::string painted(std::string_view text, Tone tone, bool colour);

class TextTable {
 public:
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  // Missing cells at the end are empty. REQUIRES: no more cells than columns.
  void add_row(std::vector<Cell> cells);
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

  // One line for the titles and each row, truncated to the width. Ignores the height.
  [[nodiscard]] std::vector<std::string> render(const Screen& screen) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace fieldcast::cli
