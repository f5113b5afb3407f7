// Decisions that all rows of a register list make together. Pure.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/import/formats/list/list_point.hpp"

namespace fieldcast::importing {

// Determines the unit of a length column by types of known width, or else by the distances of
// consecutive addresses.
class LengthVote {
 public:
  void add_type(const Length& length, unsigned bits);
  // Adds a value whose successor is `step` registers after it.
  void add_step(const Length& length, std::uint32_t step);
  // Empty without votes or in a tie.
  [[nodiscard]] std::optional<LengthUnit> unit() const;

 private:
  using Votes = std::array<std::size_t, 3>;  // by LengthUnit
  static void add(Votes& votes, const Length& length, unsigned bits);
  static std::optional<LengthUnit> most(const Votes& votes);

  Votes by_type_{}, by_step_{};
};

// Numbers such as 40001 may be references, which count from 1, or plain numbers. All valid rows are
// compared.

// True if every row may be a reference. Accepts a few contradictions if more rows in two areas
// agree; the caller refuses those.
[[nodiscard]] bool references_count_from_one(std::span<const ListEntry> entries);

// Describes the rows that are against references; empty if there are none.
[[nodiscard]] std::string note_of_references(std::span<const ListEntry> entries,
                                             const Columns& columns);

struct Placed {
  std::optional<std::uint16_t> device;  // only values of the same device are compared
  ModbusArea area = ModbusArea::kHolding;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;
  unsigned registers = 1;
  Point* point = nullptr;
};

// Adds a note to each value that shares some registers, or the same bit, with a different value:
// one of the two is wrong, usually in its type or address. Bits in a register, and two values of
// exactly the same registers, are allowed.
void note_overlaps(std::vector<Placed> values);

}  // namespace fieldcast::importing
