// Converts between items and the bits of a value. Only used by the two parts of value_codec.
#pragma once

#include <cstdint>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {

// The items of the value alone, without those of its exponent.
[[nodiscard]] std::uint32_t value_items(const Encoding& encoding, unsigned item_bits);

// The bits of a numeric value, right-aligned. kRange: an item holds more than the type can. With
// Encoding::bit only its byte counts.
[[nodiscard]] tl::expected<std::uint64_t, Cause> gather_bits(const Encoding& encoding,
                                                             unsigned item_bits, ByteView items);

// Wider items are filled with the sign (signed types) or zeros.
[[nodiscard]] Bytes spread_bits(const Encoding& encoding, unsigned item_bits, std::uint64_t bits);

// Converts between a value and its raw number, without the scale, as the bits of its type.
[[nodiscard]] tl::expected<std::uint64_t, Cause> bits_of_value(const Encoding& encoding,
                                                               const Value& value);
[[nodiscard]] tl::expected<Value, Cause> value_of_bits(const Encoding& encoding, std::uint64_t bits,
                                                       int exponent = 0);

[[nodiscard]] bool is_not_available(const Encoding& encoding, std::uint64_t bits);

// In reading order: swaps the bytes of each word if required. Word order does not apply.
[[nodiscard]] Bytes string_bytes_of(const Encoding& encoding, unsigned item_bits, ByteView items);
[[nodiscard]] Bytes items_of_string(const Encoding& encoding, unsigned item_bits, ByteView text);

[[nodiscard]] constexpr bool is_signed(ValueType type) {
  return type == ValueType::kInt8 || type == ValueType::kInt16 || type == ValueType::kInt32 ||
         type == ValueType::kInt64;
}
[[nodiscard]] constexpr bool is_float(ValueType type) {
  return type == ValueType::kFloat32 || type == ValueType::kFloat64;
}

}  // namespace fieldcast
