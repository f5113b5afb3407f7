// Numbers that a device writes as text: "+025.00", "  25,0", "1.5e-3", "00FF". Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/cause.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// How the number stands in its characters. What is read may have a sign, blanks around it and
// behind the sign, and an exponent, whatever the form in which it is written.
struct TextNumber {
  enum class Kind : std::uint8_t {
    kNone,          // the value is no text
    kDecimal,       // "-25.0"
    kDecimalComma,  // "-25,0"
    kHex,           // "FFE7": the bits of the value's type, highest digit first
  };
  Kind kind = Kind::kNone;
  std::int8_t decimals = -1;   // written behind the mark; -1: as many as the number needs and fit
  bool leading_zeros = false;  // written in front of the digits; else blanks in front of all
  bool plus = false;           // written before a number that is not negative
  [[nodiscard]] explicit operator bool() const { return kind != Kind::kNone; }
  friend bool operator==(const TextNumber&, const TextNumber&) = default;
};

// The form that a picture shows: "+000.00", "0000", "00,0". Its length is the number of characters.
[[nodiscard]] std::optional<TextNumber> text_number_from_picture(std::string_view picture);

// A decimal number as an int64 where it is one, a uint64 where it is too large for that, else a
// double. kRange: no number, or none that these types hold.
[[nodiscard]] tl::expected<Value, Cause> read_decimal(TextNumber::Kind kind,
                                                      std::string_view characters);
// Up to 16 hexadecimal digits of either case, with blanks around them and "0x" before or "h" behind
// them.
[[nodiscard]] std::optional<std::uint64_t> read_hex(std::string_view characters);

// Exactly `width` characters. A fraction is rounded to what fits or to `decimals`; kRange: the
// whole part or the sign does not fit, or nothing of the number would be left. REQUIRES: an int64,
// a uint64 or a finite double; `single`: a double that is a float, in the digits of one.
[[nodiscard]] tl::expected<std::string, Cause> write_decimal(const TextNumber& form,
                                                             std::size_t width, const Value& number,
                                                             bool single);
[[nodiscard]] tl::expected<std::string, Cause> write_hex(std::size_t width, std::uint64_t bits);

}  // namespace fieldcast
