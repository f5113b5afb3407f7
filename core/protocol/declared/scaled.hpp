// Values that other fields of their frame scale or sign: 1250 with 2 decimals is 12.50. Their
// places contain text, so that each of them is exact. Pure functions.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::declared {

struct Decimal {
  bool negative = false;
  std::uint64_t digits = 0;
  int exponent = 0;
  // Whether it is this number with the decimals of `other`, rounded.
  [[nodiscard]] bool rounds_to(const Decimal& other) const;
};

// Accepts blanks, a sign, a point or comma, and an exponent. Empty if it has too many digits.
[[nodiscard]] std::optional<Decimal> decimal_from(std::string_view text);
// "-12.50", or "5e-128" where that needs more than kScaledCharacters.
[[nodiscard]] std::string to_text(const Decimal& decimal);

// The scaled value `at` of a received frame. Empty if it has no digits, or too large an exponent.
// `starts`: of each field, or of its word.
[[nodiscard]] std::optional<Decimal> scaled_value(const Frame& frame, std::size_t at,
                                                  ByteView bytes,
                                                  std::span<const std::size_t> starts);

// Numbers of the scaled values, exponents and signs that write `items`, by the index of the field.
// As many decimals as fit are sent; the rest is rounded. Empty if a field cannot hold its number.
// `first`: item of the record in which `items` begin.
[[nodiscard]] std::optional<std::map<std::size_t, std::uint64_t>> scaled_numbers(
    const Frame& frame, ByteView items, std::uint32_t first);

// The exponents that a field can represent, limited to those of scaled_value().
struct ExponentRange {
  int lowest = 0, highest = 0;
};
[[nodiscard]] ExponentRange exponents_of(const Field& exponent);
// Largest number without its sign of a scaled value that is not text.
[[nodiscard]] std::uint64_t largest_magnitude(const Field& value);

}  // namespace fieldcast::declared
