// Channel values from raw items and back: types, word and byte order, bit of a word, scale and offset.
// Nothing wraps around: what does not fit is a fault. Pure functions.
//
// Raw items are the protocol's items in its canonical image (protocol.hpp): bit items one byte each (0 or 1), 8-bit items one
// byte, wider items big-endian.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

enum class ValueType : std::uint8_t {
  kBool,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kBcd16,
  kBcd32,
  kString
};
[[nodiscard]] std::string_view to_text(ValueType type);                         // "bool", "int16", ... "bcd32", "string"
[[nodiscard]] std::optional<ValueType> value_type_from(std::string_view text);  // without the (n) of a string

enum class WordOrder : std::uint8_t {
  kBigEndian,
  kLittleEndian
};  // of the 16-bit words of a wider value: high word first, or low word first
enum class ByteOrder : std::uint8_t { kBigEndian, kLittleEndian };  // of the two bytes of each word

// How a channel's value lies in its items.
struct Encoding {
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;  // for kString: n of string(n), 1..250
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  std::optional<std::uint8_t> bit;  // for kBool inside an item wider than a bit: 0 is the least significant
  double scale = 1.0;               // value = raw * scale + offset; anything but 1 and 0 makes the value a double
  double offset = 0.0;
  [[nodiscard]] bool scaled() const { return scale != 1.0 || offset != 0.0; }
  friend bool operator==(const Encoding&, const Encoding&) = default;
};

// Bits of the type on the wire: 16 for int16, 8 * n for string(n), 1 for bool.
[[nodiscard]] unsigned width_bits(const Encoding& encoding);

// Items of item_bits each that hold one value. A bool is one item; int32 in 16-bit items is two.
[[nodiscard]] std::uint32_t item_count(const Encoding& encoding, unsigned item_bits);

// The value, or kRange: a NaN or infinite float, a BCD digit above 9, a scaled value that is not finite.
// REQUIRES: items holds item_count() items of item_bits.
[[nodiscard]] tl::expected<Value, Cause> decode_value(const Encoding& encoding, unsigned item_bits, ByteView items);

// The items of a value. kWrongType: a text for a number, a fraction for an unscaled integer, a string for a bool;
// kRange: does not fit the type after the scale is undone (rounded to nearest), string too long.
// For a bool with `bit`, `items` comes back as the mask of that bit, all ones or all zeros under it: see merge_bit().
[[nodiscard]] tl::expected<Bytes, Cause> encode_value(const Encoding& encoding, unsigned item_bits, const Value& value);

// Puts bit `bit` of one item of item_bits to `on` in its canonical image.
void merge_bit(Bytes& item, unsigned bit, bool on);

// A text as people type it, in the form that the channel's type wants: "true", "on", "1", "-12", "0x1F", "2.5".
[[nodiscard]] tl::expected<Value, Cause> parse_value(const Encoding& encoding, std::string_view text);

}  // namespace fieldcast
