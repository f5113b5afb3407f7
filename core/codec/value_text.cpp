#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/codec/date_time.hpp"
#include "core/codec/raw_items.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

struct TypeRow {
  ValueType type;
  std::string_view name;
  unsigned width;
};
constexpr std::array kTypes{
    TypeRow{ValueType::kBool, "bool", 1},        TypeRow{ValueType::kInt16, "int16", 16},
    TypeRow{ValueType::kUint16, "uint16", 16},   TypeRow{ValueType::kInt32, "int32", 32},
    TypeRow{ValueType::kUint32, "uint32", 32},   TypeRow{ValueType::kInt64, "int64", 64},
    TypeRow{ValueType::kUint64, "uint64", 64},   TypeRow{ValueType::kFloat32, "float32", 32},
    TypeRow{ValueType::kFloat64, "float64", 64}, TypeRow{ValueType::kBcd16, "bcd16", 16},
    TypeRow{ValueType::kBcd32, "bcd32", 32},     TypeRow{ValueType::kString, "string", 0},
    TypeRow{ValueType::kInt8, "int8", 8},        TypeRow{ValueType::kUint8, "uint8", 8},
    TypeRow{ValueType::kBcd8, "bcd8", 8},
};
constexpr std::array kPlainTypes{ValueType::kBool,    ValueType::kInt8,    ValueType::kUint8,
                                 ValueType::kInt16,   ValueType::kUint16,  ValueType::kInt32,
                                 ValueType::kUint32,  ValueType::kInt64,   ValueType::kUint64,
                                 ValueType::kFloat32, ValueType::kFloat64, ValueType::kBcd8,
                                 ValueType::kBcd16,   ValueType::kBcd32};
static_assert(kPlainTypes.size() + 1 == kTypes.size());  // and string(n)
static_assert([] {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (kTypes[i].type != static_cast<ValueType>(i)) return false;
  }
  return true;
}());

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

using Parsed = tl::expected<Value, Cause>;

Parsed parse_bool(std::string_view text) {
  const std::string word = lower(text);
  for (const std::string_view on : {"true", "on", "yes", "1"}) {
    if (word == on) return Value{true};
  }
  for (const std::string_view off : {"false", "off", "no", "0"}) {
    if (word == off) return Value{false};
  }
  return tl::unexpected(Cause::kWrongType);
}

// "-12", "0x1F", "2.5e3" as an integer if possible, else as a double.
Parsed parse_number(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || text.front() == '-' || text.front() == '+')
    return tl::unexpected(Cause::kWrongType);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const char* const first = text.data() + (hex ? 2 : 0);
  const char* const last = text.data() + text.size();

  std::uint64_t magnitude = 0;
  const auto whole = std::from_chars(first, last, magnitude, hex ? 16 : 10);
  if (whole.ptr == last && first != last) {
    constexpr std::uint64_t kTwo63 = std::uint64_t{1} << 63;
    if (whole.ec != std::errc{} || (negative && magnitude > kTwo63))
      return tl::unexpected(Cause::kRange);
    if (!negative)
      return magnitude < kTwo63 ? Value{static_cast<std::int64_t>(magnitude)} : Value{magnitude};
    return Value{magnitude == kTwo63 ? std::numeric_limits<std::int64_t>::min()
                                     : -static_cast<std::int64_t>(magnitude)};
  }
  double number = 0;
  const auto real = std::from_chars(first, last, number);
  if (hex || real.ptr != last || first == last) return tl::unexpected(Cause::kWrongType);
  if (real.ec != std::errc{} || !std::isfinite(number)) return tl::unexpected(Cause::kRange);
  return Value{negative ? -number : number};
}

Parsed as_double(const Value& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return Value{static_cast<double>(*i)};
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return Value{static_cast<double>(*u)};
  return value;
}

Parsed as_integer(ValueType type, const Value& value) {
  if (const auto* d = std::get_if<double>(&value)) {
    if (*d != std::trunc(*d)) return tl::unexpected(Cause::kWrongType);
    constexpr double kTwo63 = 9223372036854775808.0;
    if (*d >= -kTwo63 && *d < kTwo63) return as_integer(type, Value{static_cast<std::int64_t>(*d)});
    if (*d >= kTwo63 && *d < 2 * kTwo63)
      return as_integer(type, Value{static_cast<std::uint64_t>(*d)});
    return tl::unexpected(Cause::kRange);
  }
  if (const auto* i = std::get_if<std::int64_t>(&value)) {
    if (is_signed(type)) return value;
    if (*i < 0) return tl::unexpected(Cause::kRange);
    return Value{static_cast<std::uint64_t>(*i)};
  }
  if (is_signed(type)) return tl::unexpected(Cause::kRange);  // 2^63 and more
  return value;
}

}  // namespace

std::string_view to_text(ValueType type) { return kTypes[static_cast<std::size_t>(type)].name; }

std::optional<ValueType> value_type_from(std::string_view text) {
  const auto row = std::ranges::find_if(
      kTypes, [&](const TypeRow& candidate) { return candidate.name == text; });
  if (row == kTypes.end()) return std::nullopt;
  return row->type;
}

std::span<const ValueType> plain_types() { return kPlainTypes; }

std::string allowed_types() {
  std::string text;
  for (const ValueType type : kPlainTypes) text += std::string(to_text(type)) + ", ";
  return text + "string(1) to string(" + std::to_string(kMaxStringBytes) + ')';
}

std::string to_text(const Encoding& encoding) {
  std::string text(to_text(encoding.type));
  if (encoding.type == ValueType::kString)
    text += '(' + std::to_string(encoding.string_bytes) + ')';
  return text;
}

std::optional<Encoding> encoding_from(std::string_view text) {
  const auto open = text.find('(');
  const auto type = value_type_from(text.substr(0, open));
  const bool has_size = open != text.npos;
  if (!type || (*type == ValueType::kString) != has_size) return std::nullopt;
  Encoding encoding{.type = *type};
  if (!has_size) return encoding;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data() + open + 1, last, encoding.string_bytes);
  if (error != std::errc{} || end + 1 != last || *end != ')') return std::nullopt;
  if (encoding.string_bytes < 1 || encoding.string_bytes > kMaxStringBytes) return std::nullopt;
  return encoding;
}

bool is_part(const Encoding& encoding, unsigned item_bits) {
  return encoding.bit && item_bits > width_bits(encoding) && width_bits(encoding) <= 8;
}

unsigned width_bits(const Encoding& encoding) {
  if (!encoding.is_text()) return kTypes[static_cast<std::size_t>(encoding.type)].width;
  if (is_date_time(encoding.layout)) return date_time_bytes(encoding.layout) * 8u;
  return (encoding.string_bytes + (encoding.layout == TextLayout::kCounted ? 2u : 0u)) * 8u;
}

std::uint32_t value_items(const Encoding& encoding, unsigned item_bits) {
  if (encoding.type == ValueType::kBool) return 1;
  return (width_bits(encoding) + item_bits - 1) / item_bits;
}

std::uint32_t item_count(const Encoding& encoding, unsigned item_bits) {
  const std::uint32_t own = value_items(encoding, item_bits);
  const std::int64_t distance = encoding.exponent_distance;
  if (distance < 0) return own + static_cast<std::uint32_t>(-distance);
  return std::max(own, static_cast<std::uint32_t>(distance) + 1);
}

tl::expected<Value, Cause> parse_value(const Encoding& encoding, std::string_view text) {
  if (encoding.type == ValueType::kString) return Value{std::string(text)};
  text = trimmed(text);
  if (encoding.type == ValueType::kBool) return parse_bool(text);
  const Parsed number = parse_number(text);
  if (!number) return number;
  if (is_float(encoding.type) || encoding.scaled()) return as_double(*number);
  return as_integer(encoding.type, *number);
}

tl::expected<std::uint64_t, Cause> parse_not_available(const Encoding& encoding,
                                                       std::string_view text) {
  const Encoding plain{.type = encoding.type};
  const std::uint64_t mask = UINT64_MAX >> (64 - width_bits(plain));
  if (text.starts_with("0x") || text.starts_with("0X")) {
    const Parsed number = parse_number(text);
    if (!number) return tl::unexpected(number.error());
    const auto* const small = std::get_if<std::int64_t>(&*number);
    const std::uint64_t bits =
        small != nullptr ? static_cast<std::uint64_t>(*small) : std::get<std::uint64_t>(*number);
    if (bits > mask) return tl::unexpected(Cause::kRange);
    return bits;
  }
  if (text == "nan" || text == "NaN" || text == ".nan" || text == ".NaN") {
    if (encoding.type == ValueType::kFloat32) return 0x7FC0'0000u;
    if (encoding.type == ValueType::kFloat64) return 0x7FF8'0000'0000'0000u;
    return tl::unexpected(Cause::kWrongType);
  }
  const auto value = parse_value(plain, text);
  if (!value) return tl::unexpected(value.error());
  const auto bits = bits_of_value(plain, *value);
  if (!bits) return tl::unexpected(bits.error());
  return *bits & mask;
}

}  // namespace fieldcast
