// Digits of the simulated devices, independent of the bridge's codec. Header only.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast::sim {

// Accepts upper case only, as the standards define.
[[nodiscard]] inline std::optional<unsigned> digit_of(std::uint8_t character) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const std::size_t at = kDigits.find(static_cast<char>(character));
  return at == std::string_view::npos ? std::nullopt
                                      : std::optional<unsigned>(static_cast<unsigned>(at));
}

// Parses all digits; empty if the column is empty, longer than 16 or has another character.
[[nodiscard]] inline std::optional<std::uint64_t> number_in(ByteView column, unsigned base = 16) {
  if (column.empty() || column.size() > 16) return std::nullopt;
  std::uint64_t number = 0;
  for (const std::uint8_t character : column) {
    const auto digit = digit_of(character);
    if (!digit || *digit >= base) return std::nullopt;
    number = number * base + *digit;
  }
  return number;
}
[[nodiscard]] inline std::optional<std::uint64_t> number_in(std::string_view text,
                                                            unsigned base = 10) {
  return number_in(ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), base);
}

// Parses a number of an address: any count of digits, hexadecimal in both cases.
[[nodiscard]] inline std::optional<std::uint64_t> address_number(std::string_view text,
                                                                 int base = 10) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

inline void append_hex(Bytes& out, std::uint64_t number, unsigned digits) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  for (unsigned left = digits; left-- > 0;)
    out.push_back(static_cast<std::uint8_t>(kDigits[number >> 4 * left & 0x0Fu]));
}

// Parses pairs of digits; empty for an odd count or another character.
[[nodiscard]] inline std::optional<Bytes> bytes_in(ByteView pairs) {
  Bytes bytes;
  for (std::size_t i = 0; i < pairs.size(); i += 2) {
    const auto byte = i + 2 <= pairs.size() ? number_in(pairs.subspan(i, 2)) : std::nullopt;
    if (!byte) return std::nullopt;
    bytes.push_back(static_cast<std::uint8_t>(*byte));
  }
  return bytes;
}

}  // namespace fieldcast::sim
