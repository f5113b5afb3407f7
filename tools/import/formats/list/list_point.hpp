// The point of one row of a list of registers: type, order, scale, unit, access and refresh. What
// the whole list decides about its addresses and lengths is in modbus_list.cpp. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/import/formats/format.hpp"
#include "tools/import/formats/list/list_address.hpp"
#include "tools/import/formats/list/list_columns.hpp"
#include "tools/import/formats/list/list_type.hpp"
#include "tools/import/formats/list/list_vote.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/model.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {

[[nodiscard]] inline bool is_empty_cell(std::string_view cell) {
  return cell.empty() || cell == "-";
}

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
  std::optional<std::string> fault{};
};

class ListPointReader {
 public:
  // `titles`: the row that names the columns. `usual`: the order of words where the list names
  // none. REQUIRES: list and titles outlive this.
  ListPointReader(const ListColumns& list, const Row& titles, std::optional<WordOrder> usual)
      : list_(list), columns_(list.columns), titles_(titles), usual_order_(usual) {}

  // Fills entry.point, which is at `reference`. Returns why the row cannot be moved, if so.
  [[nodiscard]] std::optional<std::string> read(ListEntry& entry, Reference reference) const;

 private:
  using MayFail = std::optional<std::string>;

  [[nodiscard]] MayFail check_bit(const ListEntry& entry, Reference& reference) const;
  [[nodiscard]] MayFail read_type(const ListEntry& entry, const Reference& reference,
                                  Point& point) const;
  [[nodiscard]] MayFail read_order(const Row& row, const TypeName& type, Point& point) const;
  [[nodiscard]] MayFail read_scale(const Row& row, Point& point) const;
  void read_scale_beside(const Row& row, Point& point) const;

  const ListColumns& list_;
  const Columns& columns_;
  const Row& titles_;
  const std::optional<WordOrder> usual_order_;
};

}  // namespace fieldcast::importing
