// Converts texts between the character set of a device and UTF-8. Core supports ASCII, UTF-8 and
// Latin-1; a library adds others. One object per bus, used on its thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/cause.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

enum class Charset : std::uint8_t { kUtf8, kLatin1, kGbk, kShiftJis };
[[nodiscard]] std::string_view to_text(Charset charset);  // "utf-8", "latin-1", "gbk", "shift-jis"

class TextCodec {
 public:
  virtual ~TextCodec() = default;
  // Printable UTF-8; invalid bytes and control characters are written as \xE4.
  [[nodiscard]] virtual std::string to_utf8(Charset charset, std::string_view bytes) = 0;
  // Empty if the text is not UTF-8, or the set lacks a character.
  [[nodiscard]] virtual std::optional<std::string> from_utf8(Charset charset,
                                                             std::string_view text) = 0;
};

// Supports only the ASCII characters of GBK and Shift-JIS. Any thread.
[[nodiscard]] TextCodec& plain_text_codec();

// How a device stores a text.
enum class TextLayout : std::uint8_t {
  kPlain,
  kCounted,      // its maximum and its actual length, a byte each, and the text: S7 STRING
  kDtl,          // S7 DTL, see date_time.hpp
  kDateAndTime,  // S7 DATE_AND_TIME
};
[[nodiscard]] constexpr bool is_date_time(TextLayout layout) {
  return layout == TextLayout::kDtl || layout == TextLayout::kDateAndTime;
}
// Characters of a date with a time: nine digits of a second, or three. REQUIRES: is_date_time().
[[nodiscard]] constexpr std::uint16_t date_time_characters(TextLayout layout) {
  return layout == TextLayout::kDtl ? 29 : 23;
}

// Numbers that a device writes as text: "+025.00", "  25,0", "1.5e-3", "00FF". Pure functions.

// The format applies to writing; a read text may always have a sign, blanks and an exponent.
struct TextNumber {
  enum class Kind : std::uint8_t {
    kNone,          // the value is not a number as text
    kDecimal,       // "-25.0"
    kDecimalComma,  // "-25,0"
    kHex,           // "FFE7": bits of the value's type, highest digit first
  };
  Kind kind = Kind::kNone;
  std::int8_t decimals = -1;   // after the mark; -1: as many as needed, if they fit
  bool leading_zeros = false;  // before the digits; otherwise blanks
  bool plus = false;           // written before a number that is not negative
  [[nodiscard]] explicit operator bool() const { return kind != Kind::kNone; }
  friend bool operator==(const TextNumber&, const TextNumber&) = default;
};

// The format of a picture: "+000.00", "0000", "00,0". Its length is the number of characters.
[[nodiscard]] std::optional<TextNumber> text_number_from_picture(std::string_view picture);

// int64 if possible, else uint64, else double. Fails with kRange if it is none of them.
[[nodiscard]] tl::expected<Value, Cause> read_decimal(TextNumber::Kind kind,
                                                      std::string_view characters);
// Accepts either case, surrounding blanks, a "0x" prefix and an "h" suffix.
[[nodiscard]] std::optional<std::uint64_t> read_hex(std::string_view characters);

// Exactly `width` characters, with the fraction rounded. Fails with kRange if the whole part or the
// sign does not fit, or only zeros would remain. REQUIRES: an int64, a uint64 or a finite double.
// `single`: the double is a float and uses its digits.
[[nodiscard]] tl::expected<std::string, Cause> write_decimal(const TextNumber& form,
                                                             std::size_t width, const Value& number,
                                                             bool single);
[[nodiscard]] tl::expected<std::string, Cause> write_hex(std::size_t width, std::uint64_t bits);

}  // namespace fieldcast
