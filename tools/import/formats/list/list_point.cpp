#include "tools/import/formats/list/list_point.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

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
    if (!scaled) point.change("decimals '{}' is taken for the resolution", cell);
  }
  if (!scaled) {
    point.scale = scale;
  } else if (scale != 1 && std::abs(point.scale / scale - 1) > 1e-9) {
    point.change("decimals '{}' is left out, the scale is taken", cell);
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
    point_.change(text, std::forward<Args>(args)...);
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

namespace {

constexpr std::array kLengthUnits{LengthUnit::kWords, LengthUnit::kBytes, LengthUnit::kBits};
constexpr std::size_t kRowsNamed = 3;

}  // namespace

void vote(UnitVotes& votes, const Length& length, unsigned bits) {
  for (const LengthUnit unit : kLengthUnits) {
    if (length.unit.value_or(unit) == unit && length.bits(unit) == bits)
      ++votes[static_cast<std::size_t>(unit)];
  }
}

std::optional<LengthUnit> most(const UnitVotes& votes) {
  for (const LengthUnit unit : kLengthUnits) {
    if (2 * votes[static_cast<std::size_t>(unit)] > votes[0] + votes[1] + votes[2]) return unit;
  }
  return std::nullopt;
}

namespace {

enum class Say { kNothing, kConfirms, kContradicts, kIsNone };

Say say_of(const ListEntry& entry) {
  const bool number = !entry.no_type && is_number(entry.type.type->type);
  if (!entry.address.is_open()) return Say::kIsNone;
  const ModbusArea area = *entry.address.reference->area;
  if (holds_bits(area) && number) return Say::kIsNone;
  if (!entry.said) return Say::kNothing;
  return *entry.said == area ? Say::kConfirms : Say::kContradicts;
}

bool is_voter(const ListEntry& entry) { return !entry.fault && entry.address.plain; }

}  // namespace

bool references_count_from_one(std::span<const ListEntry> entries) {
  std::vector<const ListEntry*> voters;
  for (const ListEntry& entry : entries) {
    if (is_voter(entry)) voters.push_back(&entry);
  }
  if (voters.empty()) return false;
  std::size_t confirm = 0, contradict = 0, confirmed_areas = 0;
  bool most_of_each = true;
  for (const ModbusArea area :
       {ModbusArea::kCoil, ModbusArea::kInput, ModbusArea::kInputRegister, ModbusArea::kHolding}) {
    const auto count = [&](Say say) {
      return static_cast<std::size_t>(std::ranges::count_if(voters, [&](const ListEntry* entry) {
        return say_of(*entry) == say && entry->address.reference->area == area;
      }));
    };
    const std::size_t yes = count(Say::kConfirms), no = count(Say::kContradicts);
    confirm += yes;
    contradict += no;
    confirmed_areas += yes > 0;
    most_of_each = most_of_each && (no == 0 || yes > no);
  }
  for (const ListEntry* entry : voters) {
    if (say_of(*entry) == Say::kIsNone) return false;
  }
  if (contradict == 0) return true;
  return confirm > contradict && (confirmed_areas >= 2 || most_of_each);
}

std::string note_of_references(std::span<const ListEntry> entries, const Columns& columns) {
  if (references_count_from_one(entries)) return {};
  const auto cell_of = [&](const ListEntry& entry) {
    return columns.cell(*entry.row, Field::kAddress);
  };
  const ListEntry* example = nullptr;
  std::string against;
  std::size_t count = 0;
  for (const ListEntry& entry : entries) {
    if (!is_voter(entry)) continue;
    const Say say = say_of(entry);
    if (say == Say::kNothing || say == Say::kConfirms) {
      if (example == nullptr) example = &entry;
      continue;
    }
    if (++count > kRowsNamed) continue;
    against += fmt::format("{}line {} ('{}'{})", against.empty() ? "" : ", ", entry.row->line,
                           cell_of(entry), say == Say::kContradicts ? " of another function" : "");
  }
  if (example == nullptr) return {};
  if (count > kRowsNamed) against += fmt::format(" and {} more", count - kRowsNamed);
  return fmt::format(
      "numbers such as '{}' (line {}) are taken as they are, not as references that count from 1, "
      "for this cannot be one: {}; if that row is wrong, take it out",
      cell_of(*example), example->row->line, against);
}

namespace {

bool same_table(const Placed& a, const Placed& b) {
  return a.device == b.device && a.area == b.area;
}

void note_both(const Placed& a, const Placed& b, std::string_view what) {
  for (const auto& [own, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    own->point->change("{} of '{}' (line {}) too", what, other->point->name,
                       other->point->origin.line);
}

}  // namespace

void note_overlaps(std::vector<Placed> values) {
  std::ranges::stable_sort(values, {}, [](const Placed& value) {
    return std::tuple(value.device, value.area, value.bit.has_value(), value.first,
                      value.bit.value_or(0));
  });
  // The previous value with the highest end.
  const Placed* last = nullptr;
  for (const Placed& value : values) {
    if (last && (!same_table(*last, value) || last->bit.has_value() != value.bit.has_value()))
      last = nullptr;
    if (last && value.bit) {
      if (last->first == value.first && last->bit == value.bit)
        note_both(*last, value, "is the bit");
    } else if (last && last->first + last->registers > value.first) {
      if (last->first != value.first || last->registers != value.registers)
        note_both(*last, value, "lies on registers");
    }
    if (!last || value.bit || value.first + value.registers > last->first + last->registers)
      last = &value;
  }
}

}  // namespace fieldcast::importing
