#pragma once

#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Cut to 64 characters, for a fault message.
[[nodiscard]] inline std::string in_quotes(std::string_view text) {
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

using ParsedOrFault = tl::expected<ParsedAddress, AddressFault>;

// Makes the faults of one notation.
struct AddressFaults {
  std::string_view allowed;
  ParsedOrFault operator()(std::string what, std::string suggestion = {}) const {
    return tl::unexpected(
        AddressFault{std::move(what), std::string(allowed), std::move(suggestion)});
  }
};

// Makes the address that of one bit of its item. Returns false if there is no such bit.
[[nodiscard]] inline bool set_bit(ParsedAddress& address, std::optional<std::uint32_t> bit,
                                  unsigned bits) {
  if (!bit || *bit >= bits) return false;
  address.bit = static_cast<std::uint8_t>(*bit);
  address.width_bits = 1;
  return true;
}

// Removes a suggestion that is not a valid address.
template <typename Parse>
[[nodiscard]] ParsedOrFault parse_with_suggestion(std::string_view at, const Parse& parse) {
  auto parsed = parse(at);
  if (!parsed && !parsed.error().suggestion.empty() && !parse(parsed.error().suggestion))
    parsed.error().suggestion.clear();
  return parsed;
}

// Reads the options of a device link; keeps the first fault.
class OptionReader {
 public:
  // Checks the device address, and the option names against `names`.
  OptionReader(const DeviceLink& link, const Traits& traits,
               std::span<const std::string_view> names);

  // "true" or "false".
  bool flag(std::string_view name, bool otherwise);
  // Index of the option's text in `choices`.
  std::size_t choice(std::string_view name, std::initializer_list<std::string_view> choices,
                     std::size_t otherwise = 0);
  std::uint32_t number(std::string_view name, std::uint32_t lowest, std::uint32_t highest,
                       std::uint32_t otherwise);
  // Null if the device does not have the option.
  [[nodiscard]] const std::string* text_of(std::string_view name) const;
  void refuse(std::string_view name, std::string what, std::string allowed);

  [[nodiscard]] const std::optional<OptionFault>& fault() const { return fault_; }

 private:
  const DeviceLink& link_;
  std::optional<OptionFault> fault_;
};

}  // namespace fieldcast
