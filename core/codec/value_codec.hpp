// Converts channel values from and to raw items: types, orders, bit of a word, scale and offset.
// Values that do not fit are faults. Pure. Raw items have the canonical image of protocol.hpp.
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

// Order of the 16-bit words of a wider value: high word first, or low word first.
enum class WordOrder : std::uint8_t { kBigEndian, kLittleEndian };
// Order of the two bytes of each word.
enum class ByteOrder : std::uint8_t { kBigEndian, kLittleEndian };

// All types but string(n), in the order of human-readable lists.
[[nodiscard]] std::span<const ValueType> plain_types();
// "bool, int8, .. bcd32, string(1) to string(250)", for fault messages.
[[nodiscard]] std::string allowed_types();
// The limit of one Modbus read: 125 registers.
inline constexpr std::uint16_t kMaxStringBytes = 250;

struct Encoding {
  ValueType type = ValueType::kUint16;
  // For kString: n of string(n), 1..kMaxStringBytes; for a number as text: its characters.
  std::uint16_t string_bytes = 0;
  TextLayout layout = TextLayout::kPlain;  // of kString
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  // Lowest bit in a wider item (8-bit types: a multiple of 8); 0 is the least significant.
  std::optional<std::uint8_t> bit;
  // value = raw * scale + offset; values other than 1 and 0 make the result a double.
  double scale = 1.0;
  double offset = 0.0;
  TextNumber text_number = {};       // for a number written as text; not for bool, BCD and kString
  Charset charset = Charset::kUtf8;  // of kString
  // Raw values that mean "no value", as bits of the type. A NaN matches every NaN. Not for bool and
  // kString.
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
// Parses what to_text() returns.
[[nodiscard]] std::optional<Encoding> encoding_from(std::string_view text);

// 16 for int16, 1 for bool, 8 * n for string(n) and for a number as text of n characters, 16 more
// for a counted string, 96 for a DTL.
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
[[nodiscard]] tl::expected<Value, Cause> decode_value(const Encoding& encoding, unsigned item_bits,
                                                      ByteView items,
                                                      TextCodec& codec = plain_text_codec());

// Encodes a value. Fails with kWrongType for a text as a number, a fraction as an unscaled integer,
// or a string as a bool. Fails with kRange
//   - if the raw number (rounded to nearest) does not fit or is in Encoding::not_available,
//   - if a text is too long, or the character set lacks a character.
// With `bit`, other bits of the item are zero: see merge_bit().
[[nodiscard]] tl::expected<Bytes, Cause> encode_value(const Encoding& encoding, unsigned item_bits,
                                                      const Value& value,
                                                      TextCodec& codec = plain_text_codec());

// A bool or a byte that is read with its whole item, and written without changing the rest.
[[nodiscard]] bool is_part(const Encoding& encoding, unsigned item_bits);

void merge_bit(Bytes& item, unsigned bit, bool on);

// Parses a value typed by a user: "true", "on", "1", "-12", "0x1F", "2.5".
[[nodiscard]] tl::expected<Value, Cause> parse_value(const Encoding& encoding,
                                                     std::string_view text);

// Parses a value of Encoding::not_available typed by a user: "0x8000" is the bits of the type,
// "nan" a NaN of a float type, "-1" a number of the type. Fails with kWrongType or kRange.
// REQUIRES: a numeric type.
[[nodiscard]] tl::expected<std::uint64_t, Cause> parse_not_available(const Encoding& encoding,
                                                                     std::string_view text);

}  // namespace fieldcast
