// Parses spreadsheet text: comma, semicolon or tab, quotes, Excel's `sep=;`. Pure. Limits: kMaxRows
// rows, kMaxCells cells each; the rest is dropped and reported.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/text/text.hpp"

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

[[nodiscard]] Result<Table> read_table(std::string_view text);

inline constexpr std::size_t kMaxUnpacked = 32u << 20;  // bytes of a part of a workbook

[[nodiscard]] bool is_xlsx(std::string_view bytes);
// Converts the first sheet of an .xlsx workbook to a text whose cells are separated by tabs.
[[nodiscard]] Result<Decoded> table_of_xlsx(std::string_view bytes);

// Lower case, letters and digits only: "Eng. Units" becomes "engunits".
[[nodiscard]] std::string column_word(std::string_view title);

enum class Field : std::uint8_t {
  kName,
  kAddress,
  kArea,
  kType,
  kAccess,
  kRefresh,
  kScaling,
  kRawLow,
  kRawHigh,
  kScaledLow,
  kScaledHigh,
  kClampLow,
  kClampHigh,
  kNegate,
  kUnit,
  kDescription,
  kScale,
  kDivisor,
  kDecimals,
  kOffset,
  kBit,
  kLength,
  kWordOrder,
  kDevice,  // device address on the bus
  kCount    // number of fields
};

class Columns {
 public:
  // Uses the first column of each field. `names` has words as column_word() returns them;
  // `word_of` normalizes titles.
  Columns(const Row& header, std::span<const Words<Field>> names,
          std::string (*word_of)(std::string_view) = column_word);

  [[nodiscard]] bool has(Field field) const { return index_of(field).has_value(); }
  [[nodiscard]] std::string_view cell(const Row& row, Field field) const;
  [[nodiscard]] std::optional<std::size_t> index_of(Field field) const {
    return indexes_[static_cast<std::size_t>(field)];
  }
  [[nodiscard]] std::vector<std::size_t> others(Field field) const;
  void set(Field field, std::optional<std::size_t> column);
  [[nodiscard]] std::size_t known() const { return known_; }
  [[nodiscard]] std::vector<std::string> ignored() const;

 private:
  std::array<std::optional<std::size_t>, static_cast<std::size_t>(Field::kCount)> indexes_{};
  std::size_t known_ = 0;
  std::vector<std::string> titles_;
  std::vector<std::optional<Field>> meant_;  // by column
};

}  // namespace fieldcast::importing
