// The numbers that a channel can have by its type, and alarm limits that none of them exceeds.
// Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"

namespace fieldcast {

struct ValueSpan {
  double least = 0, greatest = 0;
};

// With scale and offset. Empty for floats, texts and bools, and if the device gives an exponent.
[[nodiscard]] std::optional<ValueSpan> span_of(const Encoding& encoding);

// One text for each: "press-1/level: no value is above the limit 'high' 70000; its type has 0 to
// 65535".
[[nodiscard]] std::vector<std::string> unreachable_limits(const BusSpec& bus);

}  // namespace fieldcast
