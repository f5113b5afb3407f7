// The point of one row of a list of registers: type, order, scale, unit, access and refresh. What
// the whole list decides about its addresses and lengths is in modbus_list.cpp. Pure.
#pragma once

#include <optional>

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

}  // namespace fieldcast::importing
