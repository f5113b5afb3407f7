#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

// "01 03 00 0A": upper case, one separator between bytes ('\0' for none).
[[nodiscard]] std::string to_hex(ByteView bytes, char separator = ' ');

// Also accepts lower case, separators (blank, tab, ':', ',', '-') and 0x prefixes between bytes.
// Empty for an odd digit count or any other character.
[[nodiscard]] std::optional<Bytes> from_hex(std::string_view text);

// Big-endian fields. REQUIRES: bytes.size() >= at + width.
[[nodiscard]] constexpr std::uint16_t read_u16(ByteView bytes, std::size_t at = 0) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}
[[nodiscard]] constexpr std::uint32_t read_u32(ByteView bytes, std::size_t at = 0) {
  return static_cast<std::uint32_t>(read_u16(bytes, at)) << 16 | read_u16(bytes, at + 2);
}
inline void append_u16(Bytes& out, std::uint16_t value) {
  out.push_back(static_cast<std::uint8_t>(value >> 8));
  out.push_back(static_cast<std::uint8_t>(value));
}
inline void append_u32(Bytes& out, std::uint32_t value) {
  append_u16(out, static_cast<std::uint16_t>(value >> 16));
  append_u16(out, static_cast<std::uint16_t>(value));
}
inline void append(Bytes& out, ByteView bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace fieldcast
