// Text of a snapshot for Prometheus. Each metric is one row of a table in metrics_text.cpp. Labels
// are configured names and enumerators, so their number is bounded. A cause has no line until it
// occurs. Pure functions; any thread.
#pragma once

#include <string>
#include <string_view>

#include "bridge/metrics/metrics_snapshot.hpp"

namespace fieldcast {

enum class MetricsFormat : std::uint8_t {
  kOpenMetrics,
  kPrometheus  // Prometheus' text format 0.0.4, if the client does not request OpenMetrics
};

[[nodiscard]] std::string metrics_text(const MetricsSnapshot& snapshot, MetricsFormat format);

[[nodiscard]] std::string_view content_type_of(MetricsFormat format);
// Returns the format that the HTTP header Accept requests.
[[nodiscard]] MetricsFormat format_for(std::string_view accept);

// Escapes backslash, quote and line feed; adds no quotes.
[[nodiscard]] std::string escaped_label(std::string_view value);

}  // namespace fieldcast
