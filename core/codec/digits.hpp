// Fixed-width numbers of ASCII digits, as in Host Link, FX and S7 freeport. Header only.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast {

// Rejects lower case, which a flipped bit may produce.
[[nodiscard]] constexpr int hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// Writes the most significant digit first.
inline void append_digits(Bytes& out, std::uint32_t value, unsigned digits,
                          std::uint32_t base = 16) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  out.resize(out.size() + digits);
  for (unsigned i = 1; i <= digits; ++i, value /= base)
    out[out.size() - i] = static_cast<std::uint8_t>(kDigits[value % base]);
}

// Empty if a character is not a digit. REQUIRES: the number fits 32 bits.
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

inline void append_hex_bytes(Bytes& out, ByteView bytes) {
  for (const std::uint8_t byte : bytes) append_digits(out, byte, 2);
}
// Empty for an odd count or an invalid digit.
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
