// Tables for terminals: columns as wide as their longest cell, colours by role. Pure: cells in,
// lines out.
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

// How much a terminal can show. Zero: no bound.
struct Screen {
  std::size_t columns = 0;
  std::size_t rows = 0;
  bool colour = false;
};

// Columns that text takes in a terminal: code points, of which each is taken to be one column wide.
[[nodiscard]] std::size_t display_width(std::string_view utf8);

// What comes from the network is shown, never obeyed (core/base/printable.hpp).
[[nodiscard]] std::string printable(std::string_view text);

// The first `columns` columns of text.
[[nodiscard]] std::string clip(std::string_view utf8, std::size_t columns);

// In the colour of the tone, where the screen has colours.
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

  // The title line and one line for each row, cut at the screen's width; of its height nothing is
  // known here.
  [[nodiscard]] std::vector<std::string> render(const Screen& screen) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace fieldcast::cli
