// The point of one row of a register list, and decisions that all rows make together. Pure.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/import/formats/list/list_columns.hpp"
#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

// A row while the list is read. One with a fault takes part in no decision about the others.
struct ListEntry {
  const Row* row = nullptr;
  Point point{};
  ListAddress address{};
  std::optional<ModbusArea> said{};     // by the function or the table
  std::optional<std::uint16_t> unit{};  // the address of its device
  ListType type{};
  std::optional<Length> length{};
  bool no_type = false;  // the cell names none
  MayFail fault{};
};

// Fills entry.point, which is at `reference`. `titles`: the row that names the columns. `usual`:
// the order of words where the list names none. Returns why the row cannot be moved, if so.
[[nodiscard]] MayFail read_list_point(const ListColumns& list, const Row& titles,
                                      std::optional<WordOrder> usual, ListEntry& entry,
                                      Reference reference);

// Votes for the unit of a length column, by LengthUnit.
using UnitVotes = std::array<std::size_t, 3>;
void vote(UnitVotes& votes, const Length& length, unsigned bits);
// Empty without votes or in a tie.
[[nodiscard]] std::optional<LengthUnit> most(const UnitVotes& votes);

// Numbers such as 40001 may be references, which count from 1, or plain numbers. True if every row
// may be a reference. Accepts a few contradictions if more rows in two areas agree; the caller
// refuses those.
[[nodiscard]] bool references_count_from_one(std::span<const ListEntry> entries);

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
