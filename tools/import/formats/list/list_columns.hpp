// Analyses whole columns of a register list. Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/formats/list/list_factor.hpp"
#include "tools/import/formats/list/list_vote.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {

struct ListColumns {
  // `header`: row with the titles.
  ListColumns(const Table& table, std::size_t header);

  enum class Gain { kNone, kDivides, kMultiplies, kUnclear };

  Columns columns;
  std::optional<unsigned> counts_from;    // first address number, from the title or a second column
  std::string counts_note;                // which of the two; empty: neither
  bool hex = false;                       // addresses without a mark are hexadecimal
  std::string hex_note;                   // reason, certain or possible; empty: none
  NumberStyle style;                      // of the factors
  Gain gain = Gain::kNone;                // of the divisor column
  std::optional<LengthUnit> length_unit;  // from the title

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
