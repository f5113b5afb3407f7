// Numbers as fixed columns of ASCII digits, the way Host Link, FX and S7 freeport write them.
// Header only.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast {

// The value of 0-9 or A-F; -1 for any other character, lower case included: a flipped bit makes
// lower case out of upper case.
[[nodiscard]] constexpr int hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// The `digits` lowest digits of value in base 16 or 10, most significant first.
inline void append_digits(Bytes& out, std::uint32_t value, unsigned digits,
                          std::uint32_t base = 16) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  out.resize(out.size() + digits);
  for (unsigned i = 1; i <= digits; ++i, value /= base)
    out[out.size() - i] = static_cast<std::uint8_t>(kDigits[value % base]);
}

// All characters as one number; nothing when one is no digit of the base. REQUIRES: the number fits
// 32 bits.
[[nodiscard]] constexpr std::optional<std::uint32_t> read_digits(ByteView characters,
                                                                 std::uint32_t base = 16) {
  std::uint32_t value = 0;
  for (const std::uint8_t c : characters) {
    const int digit = hex_digit(c);
    if (digit < 0 || static_cast<std::uint32_t>(digit) >= base) return std::nullopt;
    value = value * base + static_cast<std::uint32_t>(digit);
  }
  return value;
}

// Two digits for each byte.
inline void append_hex_bytes(Bytes& out, ByteView bytes) {
  for (const std::uint8_t byte : bytes) append_digits(out, byte, 2);
}
// Nothing for an odd count or a character that is no digit.
[[nodiscard]] inline std::optional<Bytes> read_hex_bytes(ByteView characters) {
  if (characters.size() % 2 != 0) return std::nullopt;
  Bytes bytes(characters.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto byte = read_digits(characters.subspan(2 * i, 2));
    if (!byte) return std::nullopt;
    bytes[i] = static_cast<std::uint8_t>(*byte);
  }
  return bytes;
}

}  // namespace fieldcast
