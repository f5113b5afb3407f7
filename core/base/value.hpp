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

}  // namespace fieldcast
