// Source: wirenboard/wb-mqtt-serial README.md (keys of a channel), src/register.cpp (addresses of
// parts), docs of Wiren Board MQTT conventions (units by control type).
#include "tools/import/formats/wb_channel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

namespace {

using MayFail = std::optional<std::string>;

struct WbArea {
  std::string_view word;
  ModbusArea area;
};
constexpr WbArea kAreas[] = {{"coil", ModbusArea::kCoil},
                             {"discrete", ModbusArea::kInput},
                             {"input", ModbusArea::kInputRegister},
                             {"press_counter", ModbusArea::kInputRegister},
                             {"holding", ModbusArea::kHolding},
                             {"holding_single", ModbusArea::kHolding},
                             {"holding_multi", ModbusArea::kHolding}};

struct WbFormat {
  std::string_view word;
  ValueType type;
};
constexpr WbFormat kFormats[] = {
    {"u16", ValueType::kUint16},     {"s16", ValueType::kInt16},     {"u8", ValueType::kUint8},
    {"s8", ValueType::kInt8},        {"u32", ValueType::kUint32},    {"s32", ValueType::kInt32},
    {"u64", ValueType::kUint64},     {"s64", ValueType::kInt64},     {"float", ValueType::kFloat32},
    {"double", ValueType::kFloat64}, {"bcd8", ValueType::kBcd8},     {"bcd16", ValueType::kBcd16},
    {"bcd32", ValueType::kBcd32},    {"string8", ValueType::kString}};

struct WbUnit {
  std::string_view word, unit;
};
constexpr WbUnit kUnits[] = {{"deg C", "°C"},   {"%, RH", "% RH"}, {"m^3", "m³"}, {"m^3/h", "m³/h"},
                             {"g/m^3", "g/m³"}, {"Па", "Pa"},      {"deg", "°"}};
constexpr WbUnit kUnitsOfTypes[] = {{"temperature", "°C"},
                                    {"rel_humidity", "% RH"},
                                    {"voltage", "V"},
                                    {"current", "A"},
                                    {"power", "W"},
                                    {"power_consumption", "kWh"},
                                    {"lux", "lx"},
                                    {"sound_level", "dB"},
                                    {"concentration", "ppm"},
                                    {"pressure", "bar"},
                                    {"resistance", "Ω"},
                                    {"atmospheric_pressure", "mbar"},
                                    {"heat_power", "Gcal/h"},
                                    {"heat_energy", "Gcal"},
                                    {"water_flow", "m³/h"},
                                    {"water_consumption", "m³"}};

std::string unit_of(const Node& channel) {
  const std::string_view said = text_at(channel, "units");
  const auto known = std::ranges::find(kUnits, said, &WbUnit::word);
  if (known != std::end(kUnits)) return std::string(known->unit);
  if (!said.empty()) return std::string(said);
  const auto by_type = std::ranges::find(kUnitsOfTypes, text_at(channel, "type"), &WbUnit::word);
  return by_type == std::end(kUnitsOfTypes) ? std::string() : std::string(by_type->unit);
}

// "109", "0x6D", "109:1:2": some bits of a register.
struct WbAddress {
  std::uint32_t first = 0;
  std::optional<unsigned> shift, width;
};

tl::expected<WbAddress, std::string> address_of(const Node& channel, Point& point) {
  std::string_view text = text_at(channel, "address");
  const std::string_view other = text_at(channel, "write_address");
  if (text.empty()) {
    if (other.empty()) return tl::unexpected(std::string("no address"));
    text = other;
    point.access = Access::kWriteOnly;
  } else if (!other.empty() && whole_from(other) != whole_from(text)) {
    point.access = Access::kReadOnly;
    point.changes.push_back(fmt::format("read only: it is written at the address {}", other));
  }
  const auto parts = split(text, ':');
  const auto first = whole_from(parts[0]);
  if (!first || *first > 65535)
    return tl::unexpected(fmt::format("'{}' is no address of Modbus", text));
  WbAddress address{static_cast<std::uint32_t>(*first), {}, {}};
  if (parts.size() == 1) return address;
  const auto shift = whole_from(parts[1]);
  const auto width = parts.size() > 2 ? whole_from(parts[2]) : std::nullopt;
  if (!shift || !width || *shift > 63 || *width > 64 || *width == 0)
    return tl::unexpected(fmt::format("'{}' is no address of Modbus", text));
  address.shift = static_cast<unsigned>(*shift);
  address.width = static_cast<unsigned>(*width);
  return address;
}

MayFail read_format(const Node& channel, Point& point) {
  std::string_view format = text_at(channel, "format");
  if (format.empty()) format = "u16";
  if (format == "string") return "a text with one character in each register";
  const auto known = std::ranges::find(kFormats, format, &WbFormat::word);
  if (known == std::end(kFormats)) return fmt::format("the format {} has no counterpart", format);
  point.type = known->type;
  const unsigned bits = point.type == ValueType::kString ? 0 : [&] {
    Encoding encoding;
    encoding.type = point.type;
    return width_bits(encoding);
  }();
  if (bits == 8) point.byte = 0;
  if (point.type == ValueType::kString) {
    const auto registers = whole_at(channel, "string_data_size");
    if (!registers || *registers == 0 || 2 * *registers > kMaxStringBytes)
      return "a text without a length of 1 to 125 registers";
    point.string_bytes = static_cast<std::uint16_t>(2 * *registers);
  }
  if (text_at(channel, "word_order") == "little_endian")
    point.word_order = WordOrder::kLittleEndian;
  if (text_at(channel, "byte_order") == "little_endian") {
    point.byte_order = ByteOrder::kLittleEndian;
    if (point.byte) point.byte = 1;
  }
  return std::nullopt;
}

// A part of a register: one bit, one byte, or all of it.
MayFail read_part(const WbAddress& address, Point& point, std::optional<std::uint8_t>& bit) {
  if (!address.width) return std::nullopt;
  const bool one_register = registers_of(point.type, 2) == 1;
  if (*address.width == 16 && *address.shift == 0 && one_register) return std::nullopt;
  if (!one_register || *address.shift > 15)
    return fmt::format("bits of a value of several registers");
  if (*address.width == 1) {
    point.type = ValueType::kBool;
    const bool swapped = point.byte_order == ByteOrder::kLittleEndian;
    bit = static_cast<std::uint8_t>(swapped ? (*address.shift + 8) % 16 : *address.shift);
    point.byte.reset();
    return std::nullopt;
  }
  if (*address.width == 8 && *address.shift % 8 == 0) {
    const bool with_sign = point.type == ValueType::kInt8 || point.type == ValueType::kInt16;
    point.type = with_sign ? ValueType::kInt8 : ValueType::kUint8;
    const bool high = (*address.shift == 8) != (point.byte_order == ByteOrder::kLittleEndian);
    point.byte = high ? 1 : 0;
    return std::nullopt;
  }
  return fmt::format("{} bits of a register; a channel has one bit, a byte or all", *address.width);
}

MayFail read_numbers(const Node& channel, Point& point) {
  for (const std::string_view key : {"scale", "offset"}) {
    if (const auto fault = fault_of_number(channel, key)) return fault;
  }
  if (const auto scale = number_at(channel, "scale"); scale && *scale != 0) point.scale = *scale;
  point.offset = number_at(channel, "offset").value_or(0);
  if (const std::string_view error = text_at(channel, "error_value"); !error.empty())
    point.changes.push_back(fmt::format("the raw value {} means an error", error));
  if (point.access == Access::kReadOnly || !is_number(point.type)) return std::nullopt;
  const auto low = number_at(channel, "min"), high = number_at(channel, "max");
  if (low && high && *low <= *high) {
    point.write_min = low;
    point.write_max = high;
  }
  return std::nullopt;
}

// Values for on and off. For a single bit, 1 is always on.
MayFail read_switch(const Node& channel, Point& point) {
  const std::string_view on = text_at(channel, "on_value");
  const std::string_view off = text_at(channel, "off_value");
  if (on.empty() && off.empty()) return std::nullopt;
  if (point.type != ValueType::kBool) {
    point.changes.push_back(fmt::format("a number: {} is on, {} is off", on.empty() ? "1" : on,
                                        off.empty() ? "0" : off));
  } else if (whole_from(on) == 0u || (!off.empty() && whole_from(off) != 0u)) {
    return fmt::format(
        "a bit that means the opposite (on_value {}, off_value {}); a channel's is on at 1",
        on.empty() ? "1" : on, off.empty() ? "0" : off);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> read_wb_channel(const Node& channel, const WbBase& base, Point& point) {
  if (child(channel, "consists_of") != nullptr)
    return "one control of several registers; write a channel for each";
  std::string_view type = text_at(channel, "reg_type");
  if (type.empty()) type = "holding";
  const auto area = std::ranges::find(kAreas, type, &WbArea::word);
  if (area == std::end(kAreas)) return fmt::format("register type '{}' is not of Modbus", type);
  point.access = can_be_written(area->area) && bool_at(channel, "readonly") != true
                     ? Access::kReadWrite
                     : Access::kReadOnly;
  const auto address = address_of(channel, point);
  if (!address) return address.error();
  if (point.access == Access::kWriteOnly && !can_be_written(area->area))
    return "a write address of an area that cannot be written";
  std::optional<std::uint8_t> bit;
  if (holds_bits(area->area)) {
    point.type = ValueType::kBool;
  } else {
    if (const auto fault = read_format(channel, point)) return fault;
    if (const auto fault = read_part(*address, point, bit)) return fault;
  }
  const std::uint64_t wide =
      holds_bits(area->area) ? 1 : registers_of(point.type, point.string_bytes);
  point.at = address_text(area->area,
                          std::uint64_t{address->first} + base.shift + base.stride * wide, bit);
  point.unit = point.type == ValueType::kBool ? std::string() : unit_of(channel);
  if (point.byte && point.access != Access::kReadOnly) {
    point.access = Access::kReadOnly;
    point.changes.emplace_back("read only: half of a register");
  }
  if (const auto fault = read_numbers(channel, point)) return fault;
  return read_switch(channel, point);
}

namespace {

constexpr unsigned kMaxConditionDepth = 50;

// or := and {"||" and}; and := comparison {"&&" comparison}; comparison := value [op value]
class ConditionParser {
 public:
  ConditionParser(std::string_view text, const ParameterValue& value_of)
      : text_(text), value_of_(value_of) {}

  std::optional<bool> parse() {
    const Value value = parse_or(0);
    skip_blanks();
    if (broken_ || at_ != text_.size()) return std::nullopt;
    return value.has_value() && *value != 0;
  }

 private:
  using Value = std::optional<double>;  // empty: an unset parameter

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n'))
      ++at_;
  }
  bool take(std::string_view word) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  Value fail() {
    broken_ = true;
    return std::nullopt;
  }

  Value parse_or(unsigned depth) {
    if (depth > kMaxConditionDepth) return fail();
    Value left = parse_and(depth);
    while (!broken_ && take("||")) {
      const Value right = parse_and(depth);
      left = left && right ? Value(*left != 0 || *right != 0) : Value(0);
    }
    return left;
  }

  Value parse_and(unsigned depth) {
    Value left = parse_comparison(depth);
    while (!broken_ && take("&&")) {
      const Value right = parse_comparison(depth);
      left = left && right ? Value(*left != 0 && *right != 0) : Value(0);
    }
    return left;
  }

  Value parse_comparison(unsigned depth) {
    const Value left = parse_value(depth);
    if (broken_) return left;
    for (const std::string_view op : {"==", "!=", ">=", "<=", ">", "<"}) {
      if (!take(op)) continue;
      const Value right = parse_value(depth);
      if (!left || !right) return Value(op == "!=" ? 1 : 0);
      return Value(compare(*left, op, *right) ? 1 : 0);
    }
    return left;
  }

  static bool compare(double left, std::string_view op, double right) {
    if (op == "==") return left == right;
    if (op == "!=") return left != right;
    if (op == ">=") return left >= right;
    if (op == "<=") return left <= right;
    return op == ">" ? left > right : left < right;
  }

  std::string_view identifier() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  Value parse_value(unsigned depth) {
    if (take("(")) {
      const Value value = parse_or(depth + 1);
      return take(")") ? value : fail();
    }
    skip_blanks();
    double number = 0;
    const auto [end, fault] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), number);
    if (fault == std::errc{}) {
      at_ = static_cast<std::size_t>(end - text_.data());
      return number;
    }
    const std::string_view name = identifier();
    if (name.empty()) return fail();
    if (name != "isDefined") return value_of_(name);
    if (!take("(")) return fail();
    const bool defined = value_of_(identifier()).has_value();
    return take(")") ? Value(defined ? 1 : 0) : fail();
  }

  std::string_view text_;
  const ParameterValue& value_of_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

}  // namespace

std::optional<bool> condition_holds(std::string_view condition, const ParameterValue& value_of) {
  return condition.size() > 10'000 ? std::nullopt : ConditionParser(condition, value_of).parse();
}

}  // namespace fieldcast::importing
