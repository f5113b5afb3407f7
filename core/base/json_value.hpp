// The value of a channel in parsed JSON, as a request contains it. Pure.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/base/value.hpp"

namespace fieldcast {

inline constexpr std::size_t kMaxJsonText = 256;  // bytes of a text

// `Tree`: nlohmann::json, which this folder does not include. Integers below 2^63 are int64. Empty
// for null, an object, an array, a number that is not finite, or a longer text.
template <class Tree>
[[nodiscard]] std::optional<Value> value_in(const Tree& json) {
  if (json.is_boolean()) return json.template get<bool>();
  if (json.is_number_unsigned()) {
    const auto number = json.template get<std::uint64_t>();
    if (std::in_range<std::int64_t>(number)) return static_cast<std::int64_t>(number);
    return number;
  }
  if (json.is_number_integer()) return json.template get<std::int64_t>();
  if (json.is_number_float() && std::isfinite(json.template get<double>()))
    return json.template get<double>();
  if (json.is_string() && json.template get_ref<const std::string&>().size() <= kMaxJsonText)
    return json.template get<std::string>();
  return std::nullopt;
}

}  // namespace fieldcast
