#include "tools/import/formats/list/list_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/value.hpp"
#include "tools/import/formats/list/list_factor.hpp"
#include "tools/import/formats/list/list_type.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

// "0.1kWh", "V x10", "1/10 V"; not "1/min", "m3".
bool holds_factor(std::string_view unit) {
  const auto is_numeral = [](char c) { return c >= '0' && c <= '9'; };
  if (unit.starts_with("1/") && unit.size() > 2 && !is_numeral(unit[2])) return false;
  const std::size_t sign = unit.find_first_of("xX*");
  const bool behind =
      sign != std::string_view::npos && sign + 1 < unit.size() && is_numeral(unit[sign + 1]);
  return behind || (!unit.empty() && is_numeral(unit[0]));
}

// "2" places, or "0.01", which can only be the resolution.
std::optional<std::string> read_decimals(std::string_view cell, bool scaled, Point& point) {
  double scale = 1;
  if (const auto digits = whole_from(cell);
      digits && cell.find_first_not_of("0123456789") == std::string_view::npos) {
    if (*digits > 12) return fmt::format("{} decimal places", *digits);
    scale = 1 / std::pow(10.0, static_cast<double>(*digits));
  } else {
    const auto number = number_from(cell);
    const double places = number && *number > 0 ? -std::log10(*number) : 0;
    if (places < 0.5 || std::abs(places - std::round(places)) > 1e-9)
      return fmt::format("decimals '{}' is no count of places", cell);
    scale = *number;
    if (!scaled)
      point.changes.push_back(fmt::format("decimals '{}' is taken for the resolution", cell));
  }
  if (!scaled) {
    point.scale = scale;
  } else if (scale != 1 && std::abs(point.scale / scale - 1) > 1e-9) {
    point.changes.push_back(fmt::format("decimals '{}' is left out, the scale is taken", cell));
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> ListPointReader::read(ListEntry& entry, Reference reference) const {
  const Row& row = *entry.row;
  Point& point = entry.point;
  const ModbusArea area = *reference.area;
  if (const auto fault = check_bit(entry, reference)) return fault;
  if (const auto fault = read_type(entry, reference, point)) return fault;
  point.at = address_text(area, reference.first, reference.bit);
  point.unit = columns_.cell(row, Field::kUnit);
  if (point.unit == "-" || point.unit == "--") point.unit.clear();
  if (columns_.has(Field::kName)) point.description = columns_.cell(row, Field::kDescription);
  const std::string_view access_cell = columns_.cell(row, Field::kAccess);
  const auto access = access_from(access_cell);
  if (!access)
    point.changes.push_back(fmt::format("access '{}' is not understood: read-only", access_cell));
  if (can_be_written(area)) point.access = access.value_or(Access::kReadOnly);
  const std::string_view refresh_cell = columns_.cell(row, Field::kRefresh);
  const auto refresh = number_from(refresh_cell);
  if (refresh && *refresh > 0 && *refresh < 1e9) {
    point.refresh = std::chrono::microseconds{static_cast<std::int64_t>(*refresh * 1000)};
  } else if (!is_empty_cell(refresh_cell)) {
    point.changes.push_back(fmt::format("refresh '{}' is no number of ms", refresh_cell));
  }
  if (const auto fault = read_scale(row, point)) return fault;
  read_scale_beside(row, point);
  return std::nullopt;
}

// Reads the scale from the unit or the remarks if the row has no column for it.
void ListPointReader::read_scale_beside(const Row& row, Point& point) const {
  const bool scaled =
      std::ranges::any_of(std::array{Field::kScale, Field::kDivisor, Field::kDecimals},
                          [&](Field field) { return !is_empty_cell(columns_.cell(row, field)); });
  const std::optional<double> weight = weight_from(columns_.cell(row, Field::kDescription));
  const auto factor = factor_of_unit(point.unit, list_.style);
  if (weight && !scaled) {
    point.scale = 1 / *weight;
    point.changes.push_back(
        fmt::format("the value weight {} of the remark divides the raw value", *weight));
  } else if (factor && !scaled && point.type != ValueType::kString) {
    point.changes.push_back(
        fmt::format("unit '{}' is taken for the scale {}", point.unit, number_text(factor->value)));
    point.scale = factor->value;
    point.unit = factor->unit;
  } else if (holds_factor(point.unit)) {
    point.changes.push_back(
        fmt::format("unit '{}' holds a number, which is no part of the scale", point.unit));
  }
}

// "40001.0" of a number is no bit: a spreadsheet wrote the address with a decimal.
std::optional<std::string> ListPointReader::check_bit(const ListEntry& entry,
                                                      Reference& reference) const {
  const std::string_view name = columns_.cell(*entry.row, Field::kType);
  const bool number = !entry.no_type && entry.type.type->type != ValueType::kBool;
  if (!number) return std::nullopt;
  if (holds_bits(*reference.area))
    return fmt::format("data type '{}' in a table of single bits", name);
  if (!reference.bit) return std::nullopt;
  if (*reference.bit != 0 || !columns_.cell(*entry.row, Field::kBit).empty())
    return fmt::format("data type '{}' at a single bit", name);
  reference.bit.reset();
  return std::nullopt;
}

std::optional<std::string> ListPointReader::read_type(const ListEntry& entry,
                                                      const Reference& reference,
                                                      Point& point) const {
  const bool bit = holds_bits(*reference.area) || reference.bit;
  const TypeName type = bit ? TypeName{.type = ValueType::kBool} : *entry.type.type;
  point.type = type.type;
  point.byte = type.byte;
  if ((point.type == ValueType::kInt8 || point.type == ValueType::kUint8) && !point.byte)
    point.byte = 0;
  if (point.type == ValueType::kBool && !bit) return "a bit of a register without its number";
  if (point.type == ValueType::kString) {
    if (type.string_bytes == 0) return kTextLength;
    point.string_bytes = type.string_bytes;
  }
  return read_order(*entry.row, type, point);
}

std::optional<std::string> ListPointReader::read_order(const Row& row, const TypeName& type,
                                                       Point& point) const {
  if (point.type == ValueType::kBool) return std::nullopt;
  const std::string_view cell = columns_.cell(row, Field::kWordOrder);
  const auto title = columns_.index_of(Field::kWordOrder);
  const bool of_bytes =
      title && column_word(titles_.cell(*title)).find("byte") != std::string::npos;
  const auto order = list_order_from(cell, of_bytes);
  if (!order) return order.error();
  const bool wide = registers_of(point.type, point.string_bytes) > 1;
  if (wide && order->words && type.word_order && *order->words != *type.word_order)
    return fmt::format("order '{}' and data type '{}' say different orders", cell,
                       columns_.cell(row, Field::kType));
  const auto words = type.word_order ? type.word_order : order->words;
  const auto bytes = type.byte_order ? type.byte_order : order->bytes;
  if (wide && point.type != ValueType::kString)
    point.word_order = words.value_or(usual_order_.value_or(WordOrder::kBigEndian));
  point.byte_order = bytes.value_or(ByteOrder::kBigEndian);
  if (wide && order->little_alone && !bytes)
    point.changes.push_back(fmt::format("order '{}' is taken for: low word first", cell));
  return std::nullopt;
}

std::optional<std::string> ListPointReader::read_scale(const Row& row, Point& point) const {
  const std::string_view divisor = columns_.cell(row, Field::kDivisor);
  const std::string_view decimals = columns_.cell(row, Field::kDecimals);
  const auto factor = factor_from(columns_.cell(row, Field::kScale), list_.style);
  if (!factor) return "scale " + factor.error();
  if (*factor) {
    point.scale = (*factor)->value;
    if (const std::string& unit = (*factor)->unit; !unit.empty() && point.unit.empty()) {
      point.unit = unit;
    } else if (!unit.empty() && unit != point.unit) {
      return fmt::format("scale '{}' names another unit than '{}'",
                         columns_.cell(row, Field::kScale), point.unit);
    }
  }
  if (!is_empty_cell(divisor)) {
    const auto number = factor_from(divisor, list_.style);
    if (!number) return "divisor " + number.error();
    if (*number && *factor && (*number)->value != 1)
      return "a scale and a divisor, of which one is too many";
    if (*number && list_.gain == ListColumns::Gain::kUnclear && (*number)->value != 1)
      return fmt::format(
          "gain '{}': others of the list are on the other side of 1, so that it "
          "is unclear whether to divide or to multiply",
          divisor);
    if (*number && !*factor)
      point.scale =
          list_.gain == ListColumns::Gain::kMultiplies ? (*number)->value : 1 / (*number)->value;
  }
  if (!is_empty_cell(decimals)) {
    if (const auto fault = read_decimals(decimals, *factor || !is_empty_cell(divisor), point))
      return fault;
  }
  const std::string_view offset = columns_.cell(row, Field::kOffset);
  if (!is_empty_cell(offset)) {
    const auto number = number_from(offset);
    if (!number) return fmt::format("offset '{}' is no number", offset);
    point.offset = *number;
  }
  return std::nullopt;
}

}  // namespace fieldcast::importing
