#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/codec/date_time.hpp"
#include "core/codec/raw_items.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

tl::expected<std::uint64_t, Cause> from_bcd(std::uint64_t bits, unsigned width) {
  std::uint64_t number = 0;
  for (unsigned shift = width; shift > 0; shift -= 4) {
    const std::uint64_t digit = bits >> (shift - 4) & 0xFu;
    if (digit > 9) return tl::unexpected(Cause::kRange);
    number = number * 10 + digit;
  }
  return number;
}

// 10^exponent, for an exponent of 0 to kMaxExponent: exact.
double power_of_ten(int exponent) {
  double power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

// raw * 10^exponent * scale + offset, with the expected decimals: 0.1 and 0.3 have no
// exact double, so 7 * 0.3 is 2.0999999999999996. Where scale and offset are decimals the sum is
// taken in whole numbers, which are exact, and divided by a power of ten once: 21 / 10 is 2.1.
double apply_scale(const Encoding& encoding, double raw, int exponent) {
  constexpr double kTwo53 = 9007199254740992.0;
  raw *= power_of_ten(exponent);
  const double divisor = power_of_ten(-exponent);
  double ten = 1;
  for (int decimals = 0; decimals <= 15 && raw == std::trunc(raw); ++decimals, ten *= 10) {
    const double scale = std::nearbyint(encoding.scale * ten);
    const double offset = std::nearbyint(encoding.offset * ten);
    if (scale / ten != encoding.scale || offset / ten != encoding.offset) continue;
    const double product = raw * scale, shift = offset * divisor;
    if (!(std::abs(product) < kTwo53 && std::abs(product + shift) < kTwo53)) break;
    return (product + shift) / (ten * divisor);
  }
  raw /= divisor;
  const double reciprocal = std::nearbyint(1.0 / encoding.scale);
  const bool exact = std::abs(reciprocal) > 1.0 && 1.0 / reciprocal == encoding.scale;
  return (exact ? raw / reciprocal : raw * encoding.scale) + encoding.offset;
}

tl::expected<Value, Cause> finite(double number) {
  if (!std::isfinite(number)) return tl::unexpected(Cause::kRange);
  return Value{number};
}

template <typename Number>
tl::expected<Value, Cause> finish(const Encoding& encoding, Number raw, int exponent) {
  if (encoding.scaled()) return finite(apply_scale(encoding, static_cast<double>(raw), exponent));
  return Value{raw};
}

tl::expected<Value, Cause> decode_bool(const Encoding& encoding, unsigned item_bits,
                                       ByteView items) {
  const std::size_t bytes = item_bits <= 8 ? 1 : item_bits / 8;
  if (items.size() < bytes) std::abort();  // see REQUIRES of decode_value()
  if (!encoding.bit)
    return Value{std::any_of(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(bytes),
                             [](auto b) { return b != 0; })};
  if (*encoding.bit >= item_bits) return tl::unexpected(Cause::kRange);
  const std::uint8_t byte = items[bytes - 1 - *encoding.bit / 8];
  return Value{(byte >> (*encoding.bit % 8) & 1) != 0};
}

// The decimal exponent of the value in `items`: an int16.
tl::expected<int, Cause> exponent_in(const Encoding& encoding, unsigned item_bits, ByteView items) {
  if (encoding.exponent_distance == 0) return 0;
  const auto item = static_cast<std::uint32_t>(std::max(0, encoding.exponent_distance));
  const Encoding whole{.type = ValueType::kInt16, .byte_order = encoding.byte_order};
  const auto bits = gather_bits(whole, item_bits, items.subspan(item * (item_bits / 8)));
  if (!bits) return tl::unexpected(bits.error());
  const auto exponent = static_cast<std::int16_t>(*bits);
  if (exponent == INT16_MIN) return tl::unexpected(Cause::kNotAvailable);
  if (std::abs(int{exponent}) > kMaxExponent) return tl::unexpected(Cause::kRange);
  return exponent;
}

ByteView own_items(const Encoding& encoding, unsigned item_bits, ByteView items) {
  if (encoding.exponent_distance >= 0) return items;
  return items.subspan(static_cast<std::uint32_t>(-encoding.exponent_distance) * (item_bits / 8));
}

// The bits of the type that a text spells.
tl::expected<std::uint64_t, Cause> bits_of_text(const Encoding& encoding, unsigned item_bits,
                                                ByteView items) {
  const Bytes bytes = string_bytes_of(encoding, item_bits, items);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (encoding.text_number.kind == TextNumber::Kind::kHex) {
    const unsigned width = width_bits(Encoding{encoding.type});
    const auto bits = read_hex(text);
    if (!bits || (width < 64 && *bits >> width != 0)) return tl::unexpected(Cause::kRange);
    return *bits;
  }
  const auto number = read_decimal(encoding.text_number.kind, text);
  if (!number) return tl::unexpected(number.error());
  const auto bits = bits_of_value(Encoding{encoding.type}, *number);
  // A fraction for an integer is out of range, not a wrong type.
  if (!bits) return tl::unexpected(Cause::kRange);
  return *bits;
}

}  // namespace

tl::expected<Value, Cause> decode_value(const Encoding& encoding, unsigned item_bits,
                                        ByteView items, TextCodec& codec) {
  if (encoding.type == ValueType::kBool) return decode_bool(encoding, item_bits, items);
  if (encoding.type == ValueType::kString) {
    const Bytes text = string_bytes_of(encoding, item_bits, items);
    if (is_date_time(encoding.layout)) return read_date_time(encoding.layout, text);
    const std::string bytes(text.begin(), std::ranges::find(text, std::uint8_t{0}));
    return Value{codec.to_utf8(encoding.charset, bytes)};
  }
  const auto bits = encoding.text_number
                        ? bits_of_text(encoding, item_bits, items)
                        : gather_bits(encoding, item_bits, own_items(encoding, item_bits, items));
  if (!bits) return tl::unexpected(bits.error());
  if (is_not_available(encoding, *bits)) return tl::unexpected(Cause::kNotAvailable);
  const auto exponent = exponent_in(encoding, item_bits, items);
  if (!exponent) return tl::unexpected(exponent.error());
  return value_of_bits(encoding, *bits, *exponent);
}

bool is_not_available(const Encoding& encoding, std::uint64_t bits) {
  const auto is_nan = [&](std::uint64_t pattern) {
    if (encoding.type == ValueType::kFloat32)
      return std::isnan(std::bit_cast<float>(static_cast<std::uint32_t>(pattern)));
    return encoding.type == ValueType::kFloat64 && std::isnan(std::bit_cast<double>(pattern));
  };
  // The bits of a negative number may be wider than its type.
  const std::uint64_t mask = UINT64_MAX >> (64 - width_bits(Encoding{.type = encoding.type}));
  return std::ranges::any_of(encoding.not_available, [&](std::uint64_t pattern) {
    return ((pattern ^ bits) & mask) == 0 || (is_nan(pattern) && is_nan(bits));
  });
}

tl::expected<Value, Cause> value_of_bits(const Encoding& encoding, std::uint64_t bits,
                                         int exponent) {
  switch (encoding.type) {
    case ValueType::kInt8:
      return finish(encoding, std::int64_t{static_cast<std::int8_t>(bits)}, exponent);
    case ValueType::kInt16:
      return finish(encoding, std::int64_t{static_cast<std::int16_t>(bits)}, exponent);
    case ValueType::kInt32:
      return finish(encoding, std::int64_t{static_cast<std::int32_t>(bits)}, exponent);
    case ValueType::kInt64: return finish(encoding, static_cast<std::int64_t>(bits), exponent);
    case ValueType::kUint8:
    case ValueType::kUint16:
    case ValueType::kUint32:
    case ValueType::kUint64: return finish(encoding, std::uint64_t{bits}, exponent);
    case ValueType::kFloat32:
    case ValueType::kFloat64: {
      const double raw =
          encoding.type == ValueType::kFloat32
              ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
              : std::bit_cast<double>(bits);
      if (!std::isfinite(raw)) return tl::unexpected(Cause::kRange);
      return finish(encoding, raw, exponent);
    }
    case ValueType::kBcd8:
    case ValueType::kBcd16:
    case ValueType::kBcd32: {
      const auto number = from_bcd(bits, width_bits(encoding));
      if (!number) return tl::unexpected(number.error());
      return finish(encoding, *number, exponent);
    }
    case ValueType::kBool:
    case ValueType::kString: break;  // handled above
  }
  std::abort();
}

}  // namespace fieldcast
