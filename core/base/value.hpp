// Value of a channel: the five members of the topic's union.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace fieldcast {

using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;

// Empty for a bool or a string.
[[nodiscard]] std::optional<double> as_number(const Value& value);

// "true", "-3", "2.5", the string itself; doubles round-trip.
[[nodiscard]] std::string to_text(const Value& value);

// Floating-point numbers as text: the fewest digits that parse to the same number, without an
// exponent from 0.0001 to 1e16. Pure functions.

// "0.1", "25", "-2.5e-07", "nan", "inf", "-inf".
[[nodiscard]] std::string number_text(double number);

// For a float32 stored as a double: "0.1" for 0.1f. Other doubles are written as such.
[[nodiscard]] std::string float32_text(double number);

}  // namespace fieldcast
