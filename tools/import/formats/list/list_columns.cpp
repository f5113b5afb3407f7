#include "tools/import/formats/list/list_columns.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "tools/import/formats/list/list_address.hpp"
#include "tools/import/formats/list/modbus_list_columns.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

ListColumns::ListColumns(const Table& table, std::size_t header)
    : columns(list_columns(table.rows[header])) {
  const Row& titles = table.rows[header];
  if (const auto address = columns.index_of(Field::kAddress)) {
    hex = column_word(titles.cell(*address)).find("hex") != std::string::npos;
    counts_from = first_address_of_title(titles.cell(*address));
    if (counts_from) counts_note = "their title says";
  }
  find_areas(table, header);
  learn_style(table, header);
  find_hex(table, header);
  if (!counts_from) compare_addresses(table, header);
  decide_gain(table, header);
  if (const auto length = columns.index_of(Field::kLength))
    length_unit = length_unit_of_title(titles.cell(*length));
}

// A type column in which every cell names a table contains the areas; then a second column has the
// types.
void ListColumns::find_areas(const Table& table, std::size_t header) {
  std::vector<std::size_t> candidates = columns.others(Field::kType);
  if (const auto first = columns.index_of(Field::kType))
    candidates.insert(candidates.begin(), *first);
  std::optional<std::size_t> types;
  for (const std::size_t column : candidates) {
    if (!names_areas(table, header, column)) {
      if (!types) types = column;
    } else if (!columns.has(Field::kArea)) {
      columns.set(Field::kArea, column);
    }
  }
  columns.set(Field::kType, types);
  release_function(table, header);
}

// A column "Function" may describe the purpose of a value instead.
void ListColumns::release_function(const Table& table, std::size_t header) {
  const auto column = columns.index_of(Field::kArea);
  if (!column) return;
  const std::string title = column_word(table.rows[header].cell(*column));
  if (title != "function" && title != "funktion" && title != "kind") return;
  for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
    const auto cell = table.rows[i].cell(*column);
    if (area_by_name(cell) || cell.find_first_of("0123456789") != std::string_view::npos) return;
  }
  columns.set(Field::kArea, std::nullopt);
}

bool ListColumns::names_areas(const Table& table, std::size_t header, std::size_t column) {
  bool any = false;
  for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
    const auto cell = table.rows[i].cell(column);
    if (cell.empty()) continue;
    if (!is_area_word(cell)) return false;
    any = true;
  }
  return any;
}

// "0012" and "000C": all are hexadecimal if they have equal lengths and one has a leading zero.
void ListColumns::find_hex(const Table& table, std::size_t header) {
  const Row* letters = nullptr;
  bool zeros = false, same = true;
  std::size_t size = 0;
  for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
    const std::string cell = lower(columns.cell(table.rows[i], Field::kAddress));
    if (cell.empty() || cell[0] < '0' || cell[0] > '9' ||
        cell.find_first_not_of("0123456789abcdef") != std::string::npos)
      continue;
    // "1e3" is a number with an exponent.
    const std::size_t letter = cell.find_first_of("abcdef");
    const bool exponent = letter != std::string::npos && cell[letter] == 'e' &&
                          cell.find_first_of("abcdef", letter + 1) == std::string::npos;
    if (exponent && letter + 1 < cell.size() && cell[0] != '0') continue;
    if (letter != std::string::npos && !letters) letters = &table.rows[i];
    same = same && (size == 0 || size == cell.size());
    size = cell.size();
    zeros = zeros || (cell[0] == '0' && cell.size() > 2);
  }
  if (!letters || hex) return;
  hex = same && zeros;
  const std::string_view cell = columns.cell(*letters, Field::kAddress);
  hex_note =
      hex ? fmt::format("all addresses are hexadecimal, as '{}' (line {}) is", cell, letters->line)
          : fmt::format(
                "the address '{}' (line {}) may be hexadecimal; the others are "
                "read as decimal",
                cell, letters->line);
}

// "Gain" has two meanings: 10 divides the raw value, 0.1 multiplies it. A divisor below one is not
// used; a column with both is unclear.
void ListColumns::decide_gain(const Table& table, std::size_t header) {
  const auto column = columns.index_of(Field::kDivisor);
  if (!column || column_word(table.rows[header].cell(*column)) != "gain") return;
  bool more = false, less = false;
  for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
    const auto factor = factor_from(table.rows[i].cell(*column), style);
    if (!factor || !*factor) continue;
    more = more || std::abs((*factor)->value) > 1;
    less = less || std::abs((*factor)->value) < 1;
  }
  gain = more && less ? Gain::kUnclear : less ? Gain::kMultiplies : Gain::kDivides;
}

// "40001 | 0000", "5001 | 5000": one of two address columns has the protocol's addresses.
void ListColumns::compare_addresses(const Table& table, std::size_t header) {
  for (const std::size_t column : columns.others(Field::kAddress)) {
    const std::string_view title = table.rows[header].cell(column);
    const bool second_hex = column_word(title).find("hex") != std::string::npos;
    bool from_one = true, from_zero = true, any = false;
    for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
      const auto listed = list_address_from(columns.cell(table.rows[i], Field::kAddress), {hex});
      const auto second = list_address_from(table.rows[i].cell(column), {second_hex});
      if (!listed || !second) continue;
      any = any || listed->plain || second->plain;
      // 300001 can only be a reference.
      const auto is_behind = [](const ListAddress& counted, std::optional<std::uint32_t> number) {
        return number && (counted.plain == *number + 1 ||
                          (counted.reference && counted.reference->first == *number));
      };
      from_one = from_one && is_behind(*listed, second->plain);
      from_zero = from_zero && is_behind(*second, listed->plain);
    }
    if (!any || from_one == from_zero) continue;
    counts_from = from_one ? 1 : 0;
    counts_note = fmt::format("the column '{}' beside them shows", title);
    return;
  }
}

// Learns the number style from all factors.
void ListColumns::learn_style(const Table& table, std::size_t header) {
  for (std::size_t i = header + 1; i < table.rows.size(); ++i) {
    for (const Field field : {Field::kScale, Field::kDivisor})
      style.learn(columns.cell(table.rows[i], field));
  }
}

}  // namespace fieldcast::importing
