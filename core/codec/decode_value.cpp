// Items to values (value_codec.hpp).
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <string>

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

// raw * scale + offset. A scale of 0.1 or 0.001 has no exact double, its reciprocal has: dividing by 10 gives the 12.3 that
// people expect where multiplying by 0.1 gives 12.300000000000001.
double apply_scale(const Encoding& encoding, double raw) {
  const double reciprocal = std::nearbyint(1.0 / encoding.scale);
  const bool exact = std::abs(reciprocal) > 1.0 && 1.0 / reciprocal == encoding.scale;
  return (exact ? raw / reciprocal : raw * encoding.scale) + encoding.offset;
}

tl::expected<Value, Cause> finite(double number) {
  if (!std::isfinite(number)) return tl::unexpected(Cause::kRange);
  return Value{number};
}

template <typename Number>
tl::expected<Value, Cause> finish(const Encoding& encoding, Number raw) {
  if (encoding.scaled()) return finite(apply_scale(encoding, static_cast<double>(raw)));
  return Value{raw};
}

tl::expected<Value, Cause> decode_bool(const Encoding& encoding, unsigned item_bits, ByteView items) {
  const std::size_t bytes = item_bits <= 8 ? 1 : item_bits / 8;
  if (items.size() < bytes) std::abort();  // REQUIRES
  if (!encoding.bit)
    return Value{std::any_of(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(bytes), [](auto b) { return b != 0; })};
  if (*encoding.bit >= item_bits) return tl::unexpected(Cause::kRange);
  const std::uint8_t byte = items[bytes - 1 - *encoding.bit / 8];
  return Value{(byte >> (*encoding.bit % 8) & 1) != 0};
}

}  // namespace

tl::expected<Value, Cause> decode_value(const Encoding& encoding, unsigned item_bits, ByteView items) {
  if (encoding.type == ValueType::kBool) return decode_bool(encoding, item_bits, items);
  if (encoding.type == ValueType::kString) {
    const Bytes text = string_bytes_of(encoding, item_bits, items);
    return Value{std::string(text.begin(), std::find(text.begin(), text.end(), std::uint8_t{0}))};
  }
  const auto bits = gather_bits(encoding, item_bits, items);
  if (!bits) return tl::unexpected(bits.error());
  switch (encoding.type) {
    case ValueType::kInt16: return finish(encoding, std::int64_t{static_cast<std::int16_t>(*bits)});
    case ValueType::kInt32: return finish(encoding, std::int64_t{static_cast<std::int32_t>(*bits)});
    case ValueType::kInt64: return finish(encoding, static_cast<std::int64_t>(*bits));
    case ValueType::kUint16:
    case ValueType::kUint32:
    case ValueType::kUint64: return finish(encoding, std::uint64_t{*bits});
    case ValueType::kFloat32:
    case ValueType::kFloat64: {
      const double raw = encoding.type == ValueType::kFloat32
                             ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(*bits)))
                             : std::bit_cast<double>(*bits);
      if (!std::isfinite(raw)) return tl::unexpected(Cause::kRange);
      return finish(encoding, raw);
    }
    case ValueType::kBcd16:
    case ValueType::kBcd32: {
      const auto number = from_bcd(*bits, width_bits(encoding));
      if (!number) return tl::unexpected(number.error());
      return finish(encoding, *number);
    }
    case ValueType::kBool:
    case ValueType::kString: break;  // done above
  }
  std::abort();
}

}  // namespace fieldcast
