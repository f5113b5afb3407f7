// Payloads of Sparkplug B. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/outlet/sparkplug/metric_type.hpp"

namespace fieldcast::forward {

inline constexpr std::string_view kRebirth = "Node Control/Rebirth";

struct Metric {
  std::string name;  // only in births
  std::optional<std::uint64_t> alias;
  UtcTime at;
  MetricType type = MetricType::kDouble;  // only births contain it
  std::optional<Value> value;             // empty: null. REQUIRES: it fits the type
  std::optional<Quality> quality;         // empty: without the property
  bool is_historical = false;
  const StationChannel* channel = nullptr;  // of a birth: unit, limits, description as properties
  bool is_writable = false;                 // of a birth
};

// 192 good, 500 stale (uncertain, or not read yet), 0 bad (6.4.7.1).
[[nodiscard]] std::uint32_t quality_code(Quality quality);
// Bad values are not sent: their metric is null.
[[nodiscard]] bool has_value(Quality quality);

// Without `seq`: NDEATH. With `is_birth`, metrics contain names and types.
[[nodiscard]] std::string encode_payload(const std::vector<Metric>& metrics,
                                         std::optional<std::uint8_t> seq, UtcTime now,
                                         bool is_birth);

struct CommandMetric {
  std::string name;  // empty: it has an alias
  std::optional<std::uint64_t> alias;
  std::optional<Value> raw;  // empty: null. An integer is unsigned
  bool is_long = false;      // the integer has 64 bits

  // The name or the alias.
  [[nodiscard]] std::string text() const;
};
// Empty if the metric has no value of this type.
[[nodiscard]] std::optional<Value> value_of(const CommandMetric& metric, MetricType type);

struct HostCommand {
  UtcTime at;  // by the clock of the host; 0: it has no time
  bool rebirth = false;
  std::vector<CommandMetric> metrics;  // without the rebirth; at most kMostCommanded
};
inline constexpr std::size_t kMostCommanded = 64;
// Of NCMD or DCMD. Untrusted. Empty if it cannot be decoded.
[[nodiscard]] std::optional<HostCommand> decode_command(std::string_view payload);

}  // namespace fieldcast::forward
