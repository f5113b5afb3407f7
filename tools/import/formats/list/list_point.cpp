#include "tools/import/formats/list/list_point.hpp"

#include <cmath>

#include "core/base/value.hpp"
#include "tools/import/formats/format.hpp"

namespace fieldcast::importing {
namespace {

// "0.1kWh", "V x10", "1/10 V"; not "1/min", "m3".
bool holds_factor(std::string_view unit) {
  if (unit.starts_with("1/") && unit.size() > 2 && !is_digit(unit[2])) return false;
  const std::size_t sign = unit.find_first_of("xX*");
  const bool behind =
      sign != std::string_view::npos && sign + 1 < unit.size() && is_digit(unit[sign + 1]);
  return behind || (!unit.empty() && is_digit(unit[0]));
}

// "2" places, or "0.01", which can only be the resolution.
MayFail read_decimals(std::string_view cell, bool scaled, Point& point) {
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

class ListPointReader {
 public:
  ListPointReader(const ListColumns& list, const Row& titles, std::optional<WordOrder> usual,
                  ListEntry& entry)
      : list_(list), titles_(titles), usual_order_(usual), entry_(entry), point_(entry.point) {}

  MayFail read(Reference reference) const {
    const ModbusArea area = *reference.area;
    if (auto fault = check_bit(reference)) return fault;
    if (auto fault = read_type(reference)) return fault;
    point_.at = address_text(area, reference.first, reference.bit);
    point_.unit = cell(Field::kUnit);
    if (is_one_of(point_.unit, "- --")) point_.unit.clear();
    if (list_.columns.has(Field::kName)) point_.description = cell(Field::kDescription);
    const auto access = access_from(cell(Field::kAccess));
    if (!access) change("access '{}' is not understood: read-only", cell(Field::kAccess));
    if (can_be_written(area)) point_.access = access.value_or(Access::kReadOnly);
    const auto refresh = number_from(cell(Field::kRefresh));
    if (refresh && *refresh > 0 && *refresh < 1e9) {
      point_.refresh = std::chrono::microseconds{static_cast<std::int64_t>(*refresh * 1000)};
    } else if (has(Field::kRefresh)) {
      change("refresh '{}' is no number of ms", cell(Field::kRefresh));
    }
    if (auto fault = read_scale()) return fault;
    read_scale_beside();
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::string_view cell(Field field) const {
    return list_.columns.cell(*entry_.row, field);
  }
  [[nodiscard]] bool has(Field field) const { return !is_empty_cell(cell(field)); }
  template <typename... Args>
  void change(fmt::format_string<Args...> text, Args&&... args) const {
    point_.changes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  // Reads the scale from the unit or the remarks if the row has no column for it.
  void read_scale_beside() const {
    const bool scaled = has(Field::kScale) || has(Field::kDivisor) || has(Field::kDecimals);
    const std::optional<double> weight = weight_from(cell(Field::kDescription));
    const auto factor = factor_of_unit(point_.unit, list_.style);
    if (weight && !scaled) {
      point_.scale = 1 / *weight;
      change("the value weight {} of the remark divides the raw value", *weight);
    } else if (factor && !scaled && point_.type != ValueType::kString) {
      change("unit '{}' is taken for the scale {}", point_.unit, number_text(factor->value));
      point_.scale = factor->value;
      point_.unit = factor->unit;
    } else if (holds_factor(point_.unit)) {
      change("unit '{}' holds a number, which is no part of the scale", point_.unit);
    }
  }

  // "40001.0" of a number is no bit: a spreadsheet wrote the address with a decimal.
  MayFail check_bit(Reference& reference) const {
    const std::string_view name = cell(Field::kType);
    const bool number = !entry_.no_type && entry_.type.type->type != ValueType::kBool;
    if (!number) return std::nullopt;
    if (holds_bits(*reference.area))
      return fmt::format("data type '{}' in a table of single bits", name);
    if (!reference.bit) return std::nullopt;
    if (*reference.bit != 0 || !cell(Field::kBit).empty())
      return fmt::format("data type '{}' at a single bit", name);
    reference.bit.reset();
    return std::nullopt;
  }

  MayFail read_type(const Reference& reference) const {
    const bool bit = holds_bits(*reference.area) || reference.bit;
    const TypeName type = bit ? TypeName{.type = ValueType::kBool} : *entry_.type.type;
    point_.type = type.type;
    point_.byte = type.byte;
    if (is_byte(point_.type) && !point_.byte) point_.byte = 0;
    if (point_.type == ValueType::kBool && !bit) return "a bit of a register without its number";
    if (point_.type == ValueType::kString) {
      if (type.string_bytes == 0) return kTextLength;
      point_.string_bytes = type.string_bytes;
    }
    return read_order(type);
  }

  MayFail read_order(const TypeName& type) const {
    if (point_.type == ValueType::kBool) return std::nullopt;
    const std::string_view said = cell(Field::kWordOrder);
    const auto title = list_.columns.index_of(Field::kWordOrder);
    const bool of_bytes = title && contains(column_word(titles_.cell(*title)), "byte");
    const auto order = list_order_from(said, of_bytes);
    if (!order) return order.error();
    const bool wide = registers_of(point_.type, point_.string_bytes) > 1;
    if (wide && order->words && type.word_order && *order->words != *type.word_order)
      return fmt::format("order '{}' and data type '{}' say different orders", said,
                         cell(Field::kType));
    const auto words = type.word_order ? type.word_order : order->words;
    const auto bytes = type.byte_order ? type.byte_order : order->bytes;
    if (wide && point_.type != ValueType::kString)
      point_.word_order = words.value_or(usual_order_.value_or(WordOrder::kBigEndian));
    point_.byte_order = bytes.value_or(ByteOrder::kBigEndian);
    if (wide && order->little_alone && !bytes)
      change("order '{}' is taken for: low word first", said);
    return std::nullopt;
  }

  MayFail read_scale() const {
    const std::string_view divisor = cell(Field::kDivisor), decimals = cell(Field::kDecimals);
    const auto factor = factor_from(cell(Field::kScale), list_.style);
    if (!factor) return "scale " + factor.error();
    if (*factor) {
      point_.scale = (*factor)->value;
      if (const std::string& unit = (*factor)->unit; !unit.empty() && point_.unit.empty()) {
        point_.unit = unit;
      } else if (!unit.empty() && unit != point_.unit) {
        return fmt::format("scale '{}' names another unit than '{}'", cell(Field::kScale),
                           point_.unit);
      }
    }
    if (has(Field::kDivisor)) {
      const auto number = factor_from(divisor, list_.style);
      if (!number) return "divisor " + number.error();
      if (*number && *factor && (*number)->value != 1)
        return "a scale and a divisor; give one of them";
      if (*number && list_.gain == ListColumns::Gain::kUnclear && (*number)->value != 1)
        return fmt::format(
            "gain '{}': others of the list are on the other side of 1, so that it "
            "is unclear whether to divide or to multiply",
            divisor);
      if (*number && !*factor)
        point_.scale =
            list_.gain == ListColumns::Gain::kMultiplies ? (*number)->value : 1 / (*number)->value;
    }
    if (has(Field::kDecimals)) {
      if (auto fault = read_decimals(decimals, *factor || has(Field::kDivisor), point_))
        return fault;
    }
    if (!has(Field::kOffset)) return std::nullopt;
    const auto offset = number_from(cell(Field::kOffset));
    if (!offset) return fmt::format("offset '{}' is no number", cell(Field::kOffset));
    point_.offset = *offset;
    return std::nullopt;
  }

  const ListColumns& list_;
  const Row& titles_;
  const std::optional<WordOrder> usual_order_;
  const ListEntry& entry_;
  Point& point_;
};

}  // namespace

MayFail read_list_point(const ListColumns& list, const Row& titles, std::optional<WordOrder> usual,
                        ListEntry& entry, Reference reference) {
  return ListPointReader(list, titles, usual, entry).read(reference);
}

}  // namespace fieldcast::importing
