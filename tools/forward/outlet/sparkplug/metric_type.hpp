// The data types of Sparkplug B for our channels and values. Pure.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/value.hpp"

namespace fieldcast::forward {

// Eclipse Sparkplug Specification 3.0.0, 6.4.16. UInt32 is not used: the specification puts it into
// another field (int_value) than widespread decoders expect (long_value).
enum class MetricType : std::uint32_t {
  kInt8 = 1,
  kInt16 = 2,
  kInt32 = 3,
  kInt64 = 4,
  kUInt8 = 5,
  kUInt16 = 6,
  kUInt64 = 8,
  kFloat = 9,
  kDouble = 10,
  kBoolean = 11,
  kString = 12,
};

// Of a channel: "int16", "string(16)". An unsigned type without its own one is kUInt64.
[[nodiscard]] MetricType metric_type_of(std::string_view channel_type);
// True if a metric of this type can have the value.
[[nodiscard]] bool fits(MetricType type, const Value& value);
// The type that every value of this kind fits: a scaled int16 is a kDouble.
[[nodiscard]] MetricType widest_type_of(const Value& value);

}  // namespace fieldcast::forward
