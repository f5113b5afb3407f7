// The columns of a register list: which title means which field, and what whole columns show.
// Pure.
#pragma once

#include <optional>
#include <string>

#include "tools/import/formats/list/list_cells.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {

// Titles may be English, German, French, Spanish or Italian, and have remarks: "Adresse (hex)". If
// no other column has the address, "offset" is the register, as in Siemens lists.
[[nodiscard]] Columns list_columns(const Row& header);

struct ListColumns {
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
  using Rows = std::span<const Row>;  // below the titles
  void compare_addresses(const Row& titles, Rows rows);
  void find_areas(Rows rows);
  void release_function(const Row& titles, Rows rows);
  void find_hex(Rows rows);
  void decide_gain(const Row& titles, Rows rows);
};

}  // namespace fieldcast::importing
