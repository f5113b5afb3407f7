// A snapshot as text for Prometheus. Pure functions; any thread.
//
// Each metric is one row of a table in metrics_text.cpp: its name, its unit, what it is, and how it
// is read from a report. Labels are names of the configuration (bus, device, area) and enumerators
// (state, cause), so their number is bounded. A cause has a line only once it has occurred.
#pragma once

#include <string>
#include <string_view>

#include "bridge/metrics/metrics_snapshot.hpp"

namespace fieldcast {

enum class MetricsFormat : std::uint8_t {
  kOpenMetrics,  // OpenMetrics 1.0
  kPrometheus    // Prometheus' text format 0.0.4, for whoever does not ask for OpenMetrics
};

[[nodiscard]] std::string metrics_text(const MetricsSnapshot& snapshot, MetricsFormat format);

// The media type, for the HTTP header Content-Type.
[[nodiscard]] std::string_view content_type_of(MetricsFormat format);
// What a client wants by its HTTP header Accept.
[[nodiscard]] MetricsFormat format_for(std::string_view accept);

// A label's value without its quotes: backslash, quote and line feed are escaped.
[[nodiscard]] std::string escaped_label(std::string_view value);

}  // namespace fieldcast
