// What whole columns of a register list say: which is of what, how numbers are written, whether
// bare addresses are hexadecimal, and what a gain means. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/columns.hpp"
#include "tools/import/formats/length_vote.hpp"
#include "tools/import/formats/list_factor.hpp"
#include "tools/import/table.hpp"

namespace fieldcast::importing {

struct ListColumns {
  // `header`: the row that names the columns.
  ListColumns(const Table& table, std::size_t header);

  enum class Gain { kNone, kDivides, kMultiplies, kUnclear };

  Columns columns;
  std::optional<unsigned> counts_from;    // the addresses, as their title or a second column says
  std::string counts_note;                // which of both; empty: neither
  bool hex = false;                       // addresses without a mark
  std::string hex_note;                   // why, or why perhaps; empty: nothing to tell
  NumberStyle style;                      // of the factors
  Gain gain = Gain::kNone;                // of the column of divisors
  std::optional<LengthUnit> length_unit;  // as the title says

 private:
  void compare_addresses(const Table& table, std::size_t header);
  void find_areas(const Table& table, std::size_t header);
  void release_function(const Table& table, std::size_t header);
  void learn_style(const Table& table, std::size_t header);
  void find_hex(const Table& table, std::size_t header);
  void decide_gain(const Table& table, std::size_t header);
  static bool names_areas(const Table& table, std::size_t header, std::size_t column);
};

}  // namespace fieldcast::importing
