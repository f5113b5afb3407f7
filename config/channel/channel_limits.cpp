#include "config/channel/channel_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/channel/channel_keys.hpp"
#include "core/model/reach.hpp"

namespace fieldcast::config {
namespace {

// A value back inside one limit by the hysteresis must not exceed the opposite one.
void check_hysteresis(MapReader& map, const Limits& limits) {
  if (limits.hysteresis < 0) map.fault("hysteresis", "hysteresis is negative", "0 and above");
  const auto lower = limits.low ? limits.low : limits.low_low;
  const auto upper = limits.high ? limits.high : limits.high_high;
  if (lower && upper && limits.hysteresis >= *upper - *lower && *upper > *lower) {
    map.fault("hysteresis", "hysteresis is as wide as the limits are apart",
              "less than their distance");
  }
}

}  // namespace

void read_limits(MapReader& channel, ChannelSpec& spec) {
  const Node* node = channel.find("limits");
  if (node == nullptr) return;
  MapReader map(*node, limit_rows(), channel.faults());
  limit_rows().read(map, spec.limits);
  const std::pair<std::string_view, const std::optional<double>*> ladder[] = {
      {"low-low", &spec.limits.low_low},
      {"low", &spec.limits.low},
      {"high", &spec.limits.high},
      {"high-high", &spec.limits.high_high}};
  std::string_view below;
  const std::optional<double>* bound = nullptr;
  for (const auto& [key, limit] : ladder) {
    if (!*limit) continue;
    if (bound != nullptr && **limit <= **bound) {
      map.fault(key, fmt::format("limit '{}' is not above '{}'", key, below),
                "low-low < low < high < high-high");
    }
    below = key, bound = limit;
  }
  check_hysteresis(map, spec.limits);
  for (const std::string_view key : {"hysteresis", "delay", "priority"}) {
    if (bound == nullptr && map.has(key)) {
      map.fault(key, fmt::format("'{}' without a limit", key), "low-low, low, high, high-high");
    }
  }
}

void read_write(MapReader& channel, ChannelSpec& spec) {
  const Node* node = channel.find("write");
  if (node == nullptr) return;
  MapReader map(*node, write_rows(), channel.faults());
  write_rows().read(map, spec);
  if (spec.write_min && spec.write_max && *spec.write_min > *spec.write_max) {
    map.fault("max", "write max is below min", "min <= max");
  }
}

void check_write_span(MapReader& map, const ChannelSpec& spec) {
  const auto span = span_of(spec.encoding);
  if (!span || (spec.write_min && spec.write_max && *spec.write_min > *spec.write_max)) return;
  double least = std::max(spec.write_min.value_or(span->least), span->least);
  double greatest = std::min(spec.write_max.value_or(span->greatest), span->greatest);
  // A scaled value is rounded after the check of the limits, others are whole.
  if (!spec.encoding.scaled()) least = std::ceil(least), greatest = std::floor(greatest);
  if (least <= greatest) return;
  map.fault("write", "no value of this channel is within its write limits",
            fmt::format("limits that overlap with {}{} to {}",
                        spec.encoding.scaled() ? "" : "whole numbers of ",
                        fieldcast::to_text(Value{span->least}),
                        fieldcast::to_text(Value{span->greatest})));
}

// A value held back by the deadband must not hide a change from one limit to the other.
void check_deadband(MapReader& map, const ChannelSpec& spec) {
  if (!spec.deadband) return;
  if (*spec.deadband < 0) map.fault("deadband", "deadband is negative", "0 and above");
  const auto lower = spec.limits.low ? spec.limits.low : spec.limits.low_low;
  const auto upper = spec.limits.high ? spec.limits.high : spec.limits.high_high;
  if (lower && upper && *upper > *lower && *spec.deadband >= *upper - *lower) {
    map.fault("deadband", "deadband is as wide as the limits are apart",
              "less than their distance");
  }
}

}  // namespace fieldcast::config
