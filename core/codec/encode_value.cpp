// kRange if a value does not fit, kWrongType for another kind of value.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "core/codec/date_time.hpp"
#include "core/codec/raw_items.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

struct RawLimits {
  std::int64_t lowest = 0;
  std::uint64_t highest = 0;
};

RawLimits limits_of(ValueType type) {
  switch (type) {
    case ValueType::kInt8: return {INT8_MIN, INT8_MAX};
    case ValueType::kInt16: return {INT16_MIN, INT16_MAX};
    case ValueType::kInt32: return {INT32_MIN, INT32_MAX};
    case ValueType::kInt64: return {INT64_MIN, INT64_MAX};
    case ValueType::kUint8: return {0, UINT8_MAX};
    case ValueType::kUint16: return {0, UINT16_MAX};
    case ValueType::kUint32: return {0, UINT32_MAX};
    case ValueType::kUint64: return {0, UINT64_MAX};
    case ValueType::kBcd8: return {0, 99};
    case ValueType::kBcd16: return {0, 9'999};
    case ValueType::kBcd32: return {0, 99'999'999};
    default: std::abort();
  }
}

std::uint64_t to_bcd(std::uint64_t number) {
  std::uint64_t bits = 0;
  for (unsigned shift = 0; number != 0; shift += 4, number /= 10) bits |= (number % 10) << shift;
  return bits;
}

using Bits = tl::expected<std::uint64_t, Cause>;

Bits checked(ValueType type, std::int64_t number) {
  const RawLimits limits = limits_of(type);
  if (number < limits.lowest) return tl::unexpected(Cause::kRange);
  if (number > 0 && static_cast<std::uint64_t>(number) > limits.highest)
    return tl::unexpected(Cause::kRange);
  return static_cast<std::uint64_t>(number);
}
Bits checked(ValueType type, std::uint64_t number) {
  if (number > limits_of(type).highest) return tl::unexpected(Cause::kRange);
  return number;
}
// REQUIRES: a whole number.
Bits checked(ValueType type, double number) {
  constexpr double kTwo63 = 9223372036854775808.0;
  if (number >= -kTwo63 && number < kTwo63) return checked(type, static_cast<std::int64_t>(number));
  if (number >= kTwo63 && number < 2 * kTwo63)
    return checked(type, static_cast<std::uint64_t>(number));
  return tl::unexpected(Cause::kRange);
}

// kWrongType for a bool or a text.
tl::expected<double, Cause> number_of(const Value& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
  if (const auto* d = std::get_if<double>(&value)) {
    if (!std::isfinite(*d)) return tl::unexpected(Cause::kRange);
    return *d;
  }
  return tl::unexpected(Cause::kWrongType);
}

double undo_scale(const Encoding& encoding, double number) {
  return encoding.scaled() ? (number - encoding.offset) / encoding.scale : number;
}

Bits float_bits(const Encoding& encoding, const Value& value) {
  const auto number = number_of(value);
  if (!number) return tl::unexpected(number.error());
  const double raw = undo_scale(encoding, *number);
  if (encoding.type == ValueType::kFloat64) {
    if (!std::isfinite(raw)) return tl::unexpected(Cause::kRange);
    return std::bit_cast<std::uint64_t>(raw);
  }
  // Compared before the conversion, which is undefined out of range.
  if (!(std::abs(raw) <= static_cast<double>(std::numeric_limits<float>::max())))
    return tl::unexpected(Cause::kRange);
  return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
}

Bits integer_bits(const Encoding& encoding, const Value& value) {
  Bits raw;
  if (encoding.scaled()) {
    const auto number = number_of(value);
    if (!number) return tl::unexpected(number.error());
    const double rounded = std::nearbyint(undo_scale(encoding, *number));
    if (!std::isfinite(rounded)) return tl::unexpected(Cause::kRange);
    raw = checked(encoding.type, rounded);
  } else if (const auto* i = std::get_if<std::int64_t>(&value)) {
    raw = checked(encoding.type, *i);
  } else if (const auto* u = std::get_if<std::uint64_t>(&value)) {
    raw = checked(encoding.type, *u);
  } else {
    const auto number = number_of(value);
    if (!number) return tl::unexpected(number.error());
    if (*number != std::trunc(*number)) return tl::unexpected(Cause::kWrongType);
    raw = checked(encoding.type, *number);
  }
  if (raw && is_bcd(encoding.type)) return to_bcd(*raw);
  return raw;
}

// Accepts true, false, 0 and 1.
tl::expected<bool, Cause> truth_of(const Value& value) {
  if (const auto* b = std::get_if<bool>(&value)) return *b;
  const auto number = number_of(value);
  if (!number) return tl::unexpected(number.error());
  if (*number != 0.0 && *number != 1.0) return tl::unexpected(Cause::kRange);
  return *number == 1.0;
}

tl::expected<Bytes, Cause> encode_bool(const Encoding& encoding, unsigned item_bits,
                                       const Value& value) {
  const auto on = truth_of(value);
  if (!on) return tl::unexpected(on.error());
  const unsigned bit = encoding.bit.value_or(0);
  if (bit >= item_bits) return tl::unexpected(Cause::kRange);
  Bytes item(item_bits <= 8 ? 1 : item_bits / 8, 0);
  merge_bit(item, bit, *on);
  return item;
}

tl::expected<Bytes, Cause> encode_string(const Encoding& encoding, unsigned item_bits,
                                         const Value& value, TextCodec& codec) {
  const auto* given = std::get_if<std::string>(&value);
  if (given == nullptr) return tl::unexpected(Cause::kWrongType);
  if (is_date_time(encoding.layout)) {
    return write_date_time(encoding.layout, *given).map([&](const Bytes& bytes) {
      return items_of_string(encoding, item_bits, bytes);
    });
  }
  const auto text = codec.from_utf8(encoding.charset, *given);
  if (!text || text->size() > encoding.string_bytes) return tl::unexpected(Cause::kRange);
  Bytes bytes;
  if (encoding.layout == TextLayout::kCounted)
    bytes = {static_cast<std::uint8_t>(encoding.string_bytes),
             static_cast<std::uint8_t>(text->size())};
  bytes.insert(bytes.end(), text->begin(), text->end());
  return items_of_string(encoding, item_bits, bytes);
}

tl::expected<Bytes, Cause> encode_text_number(const Encoding& encoding, unsigned item_bits,
                                              std::uint64_t bits) {
  tl::expected<std::string, Cause> text;
  if (encoding.text_number.kind == TextNumber::Kind::kHex) {
    const unsigned width = width_bits(Encoding{encoding.type});
    text = write_hex(encoding.string_bytes, bits & UINT64_MAX >> (64 - width));
  } else {
    const auto raw = value_of_bits(Encoding{encoding.type}, bits);
    if (!raw) return tl::unexpected(raw.error());
    text = write_decimal(encoding.text_number, encoding.string_bytes, *raw,
                         encoding.type == ValueType::kFloat32);
  }
  if (!text) return tl::unexpected(text.error());
  return items_of_string(encoding, item_bits,
                         {reinterpret_cast<const std::uint8_t*>(text->data()), text->size()});
}

}  // namespace

tl::expected<std::uint64_t, Cause> bits_of_value(const Encoding& encoding, const Value& value) {
  return is_float(encoding.type) ? float_bits(encoding, value) : integer_bits(encoding, value);
}

tl::expected<Bytes, Cause> encode_value(const Encoding& encoding, unsigned item_bits,
                                        const Value& value, TextCodec& codec) {
  if (encoding.exponent_distance != 0) return tl::unexpected(Cause::kReadOnly);
  if (encoding.type == ValueType::kBool) return encode_bool(encoding, item_bits, value);
  if (encoding.type == ValueType::kString) return encode_string(encoding, item_bits, value, codec);
  const Bits bits = bits_of_value(encoding, value);
  if (!bits) return tl::unexpected(bits.error());
  if (is_not_available(encoding, *bits)) return tl::unexpected(Cause::kRange);
  if (encoding.text_number) return encode_text_number(encoding, item_bits, *bits);
  return spread_bits(encoding, item_bits, *bits);
}

void merge_bit(Bytes& item, unsigned bit, bool on) {
  if (bit / 8 >= item.size()) std::abort();  // the caller must pass a bit within the item
  std::uint8_t& byte = item[item.size() - 1 - bit / 8];
  const auto mask = static_cast<std::uint8_t>(1u << bit % 8);
  byte = static_cast<std::uint8_t>(on ? byte | mask : byte & ~mask);
}

}  // namespace fieldcast
