// Channel values from raw items and back: types, word and byte order, bit of a word, scale and
// offset. Nothing wraps around: what does not fit is a fault. Pure functions.
//
// Raw items are the protocol's items in its canonical image (protocol.hpp): bit items one byte each
// (0 or 1), 8-bit items one byte, wider items big-endian.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/value.hpp"
#include "core/codec/text_codec.hpp"
#include "core/codec/text_number.hpp"

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
  kString,
  kInt8,
  kUint8,
  kBcd8
};
[[nodiscard]] std::string_view to_text(ValueType type);  // "bool", "int8", ... "bcd32", "string"
[[nodiscard]] constexpr bool is_bcd(ValueType type) {
  return type == ValueType::kBcd8 || type == ValueType::kBcd16 || type == ValueType::kBcd32;
}
// Without the (n) of a string.
[[nodiscard]] std::optional<ValueType> value_type_from(std::string_view text);

// Of the 16-bit words of a wider value: high word first, or low word first.
enum class WordOrder : std::uint8_t { kBigEndian, kLittleEndian };
// Of the two bytes of each word.
enum class ByteOrder : std::uint8_t { kBigEndian, kLittleEndian };

// Every type but string(n), in the order in which people are told of them.
[[nodiscard]] std::span<const ValueType> plain_types();
// "bool, int8, .. bcd32, string(1) to string(250)": what is allowed, for faults.
[[nodiscard]] std::string allowed_types();
// What one Modbus read carries: 125 registers.
inline constexpr std::uint16_t kMaxStringBytes = 250;

// How a channel's value lies in its items.
struct Encoding {
  ValueType type = ValueType::kUint16;
  // For kString: n of string(n), 1..kMaxStringBytes; for a number as text: its characters.
  std::uint16_t string_bytes = 0;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  // Inside an item wider than the value: of a bool its bit, of an 8-bit type the lowest of its
  // eight bits (a multiple of 8). 0 is the least significant.
  std::optional<std::uint8_t> bit;
  // value = raw * 10^exponent * scale + offset; a scale, an offset or an exponent makes the value a
  // double.
  double scale = 1.0;
  double offset = 0.0;
  TextNumber text_number = {};       // a number that stands as text; not for bool, BCD and kString
  Charset charset = Charset::kUtf8;  // of kString
  // Raw values that mean "no value", before scale and offset, as the bits of the type. A NaN stands
  // for every NaN. Not for bool and kString.
  std::vector<std::uint64_t> not_available{};
  // Items from the value's first one to the one that holds its decimal exponent; negative where the
  // exponent is before the value. 0: no exponent. Only for integers and BCD in items of 16 bits.
  std::int32_t exponent_distance = 0;
  [[nodiscard]] bool is_text() const { return type == ValueType::kString || text_number; }
  [[nodiscard]] bool scaled() const {
    return scale != 1.0 || offset != 0.0 || exponent_distance != 0;
  }
  friend bool operator==(const Encoding&, const Encoding&) = default;
};

[[nodiscard]] std::string to_text(const Encoding& encoding);  // "float32", "string(16)"

// Bits of the value on the wire: 16 for int16, 8 * n for string(n) and for a number as text of n
// characters, 1 for bool.
[[nodiscard]] unsigned width_bits(const Encoding& encoding);

// The largest decimal exponent of a value, and the negative of the smallest one.
inline constexpr int kMaxExponent = 10;

// Items of item_bits each that are read for one value: those of the value, those of its exponent,
// and those between. A bool is one item; int32 in 16-bit items is two.
[[nodiscard]] std::uint32_t item_count(const Encoding& encoding, unsigned item_bits);

// The value. kNotAvailable: one of Encoding::not_available, or the exponent is 0x8000 (SunSpec's
// "not implemented"); kRange: a NaN or infinite float, a BCD digit above 9, a scaled value that is
// not finite, a text that spells no number of the type, an exponent beyond kMaxExponent.
// REQUIRES: items holds item_count() items of item_bits.
// A string comes as printable UTF-8, by the codec.
[[nodiscard]] tl::expected<Value, Cause> decode_value(const Encoding& encoding, unsigned item_bits,
                                                      ByteView items,
                                                      TextCodec& codec = plain_text_codec());

// The items of a value. kWrongType: a text for a number, a fraction for an unscaled integer, a
// string for a bool; kRange: does not fit the type after the scale is undone (rounded to nearest),
// is one of Encoding::not_available, a string or the text of a number is too long, a text has
// characters that the channel's character set lacks; kReadOnly: the value has an exponent. With
// `bit` the item holds zeros beside that bit, or that byte: see merge_bit().
[[nodiscard]] tl::expected<Bytes, Cause> encode_value(const Encoding& encoding, unsigned item_bits,
                                                      const Value& value,
                                                      TextCodec& codec = plain_text_codec());

// A bool or a byte inside an item that is wider: it is read with the whole item, and written
// without touching the rest of it.
[[nodiscard]] bool is_part(const Encoding& encoding, unsigned item_bits);

// Puts bit `bit` of one item of item_bits to `on` in its canonical image.
void merge_bit(Bytes& item, unsigned bit, bool on);

// A text as people type it, in the form that the channel's type wants: "true", "on", "1", "-12",
// "0x1F", "2.5".
[[nodiscard]] tl::expected<Value, Cause> parse_value(const Encoding& encoding,
                                                     std::string_view text);

// One value of Encoding::not_available as a user types it: "0x8000" is the bits of the type, "nan"
// a NaN of a float type, "-1" a number of the type. Fails with kWrongType or kRange. REQUIRES: a
// numeric type.
[[nodiscard]] tl::expected<std::uint64_t, Cause> parse_not_available(const Encoding& encoding,
                                                                     std::string_view text);

}  // namespace fieldcast
