#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Cut to 64 characters, for a fault message.
[[nodiscard]] inline std::string quoted(std::string_view text) {
  return "'" + std::string(text.substr(0, 64)) + "'";
}

// UINT32_MAX if it is too large for any area; empty if it is not a number of that base.
[[nodiscard]] inline std::optional<std::uint32_t> whole_number(std::string_view text,
                                                               int base = 10) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || end != text.data() + text.size()) return std::nullopt;
  return error == std::errc{} ? value : UINT32_MAX;
}

[[nodiscard]] inline std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return upper;
}

// Removes a suggestion that is not a valid address.
template <typename Parse>
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_with_suggestion(std::string_view at,
                                                                              const Parse& parse) {
  auto parsed = parse(at);
  if (!parsed && !parsed.error().suggestion.empty() && !parse(parsed.error().suggestion))
    parsed.error().suggestion.clear();
  return parsed;
}

}  // namespace fieldcast
