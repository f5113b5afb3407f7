#include "tools/forward/outlet/sparkplug/metric_type.hpp"

#include <limits>
#include <utility>

namespace fieldcast::forward {

namespace {

constexpr std::pair<std::string_view, MetricType> kTypes[] = {
    {"bool", MetricType::kBoolean},   {"int8", MetricType::kInt8},
    {"int16", MetricType::kInt16},    {"int32", MetricType::kInt32},
    {"int64", MetricType::kInt64},    {"uint8", MetricType::kUInt8},
    {"uint16", MetricType::kUInt16},  {"uint32", MetricType::kUInt64},
    {"uint64", MetricType::kUInt64},  {"float32", MetricType::kFloat},
    {"float64", MetricType::kDouble}, {"bcd8", MetricType::kUInt64},
    {"bcd16", MetricType::kUInt64},   {"bcd32", MetricType::kUInt64},
};

bool in_range(MetricType type, std::int64_t number) {
  const auto within = [number](std::int64_t low, std::int64_t high) {
    return number >= low && number <= high;
  };
  switch (type) {
    case MetricType::kInt8: return within(INT8_MIN, INT8_MAX);
    case MetricType::kInt16: return within(INT16_MIN, INT16_MAX);
    case MetricType::kInt32: return within(INT32_MIN, INT32_MAX);
    case MetricType::kInt64: return true;
    case MetricType::kUInt8: return within(0, UINT8_MAX);
    case MetricType::kUInt16: return within(0, UINT16_MAX);
    case MetricType::kUInt64: return number >= 0;
    default: return false;
  }
}

struct Fits {
  MetricType type;
  bool operator()(bool) const { return type == MetricType::kBoolean; }
  bool operator()(std::int64_t number) const { return in_range(type, number); }
  bool operator()(std::uint64_t number) const {
    return type == MetricType::kUInt64 ||
           (number <= INT64_MAX && in_range(type, static_cast<std::int64_t>(number)));
  }
  bool operator()(double number) const {
    if (type == MetricType::kDouble) return true;
    return type == MetricType::kFloat &&
           (number != number || static_cast<double>(static_cast<float>(number)) == number);
  }
  bool operator()(const std::string&) const { return type == MetricType::kString; }
};

struct Widest {
  MetricType operator()(bool) const { return MetricType::kBoolean; }
  MetricType operator()(std::int64_t) const { return MetricType::kInt64; }
  MetricType operator()(std::uint64_t) const { return MetricType::kUInt64; }
  MetricType operator()(double) const { return MetricType::kDouble; }
  MetricType operator()(const std::string&) const { return MetricType::kString; }
};

}  // namespace

MetricType metric_type_of(std::string_view channel_type) {
  for (const auto& [text, type] : kTypes) {
    if (text == channel_type) return type;
  }
  return channel_type.starts_with("string") ? MetricType::kString : MetricType::kDouble;
}

bool fits(MetricType type, const Value& value) { return std::visit(Fits{type}, value); }

MetricType widest_type_of(const Value& value) { return std::visit(Widest{}, value); }

}  // namespace fieldcast::forward
