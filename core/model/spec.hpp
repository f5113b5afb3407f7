// The configuration with all defaults. Plain values, created by the loader, which also checks names
// (1..64 of letters, digits, '-', '_', '.').
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/dds_spec.hpp"
#include "core/model/program_spec.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

enum class LogLevel : std::uint8_t { kError, kWarning, kInfo, kDebug };
[[nodiscard]] std::string_view to_text(LogLevel level);  // "error", "warning", "info", "debug"

struct LogSpec {
  LogLevel level = LogLevel::kInfo;
  friend bool operator==(const LogSpec&, const LogSpec&) = default;
};

// Serves metrics to a scraper (Prometheus), by plain HTTP and without a login.
struct MetricsSpec {
  ListenSpec listen;
  friend bool operator==(const MetricsSpec&, const MetricsSpec&) = default;
};

// Whether engineers may change the configuration file through the bridge.
struct ConfigureSpec {
  bool allow = false;
  friend bool operator==(const ConfigureSpec&, const ConfigureSpec&) = default;
};

// Bridges with the same channels that stand by for each other.
struct StandbySpec {
  std::string group;
  std::int32_t strength = 0;  // the strongest ready bridge takes over; 0..1000
  friend bool operator==(const StandbySpec&, const StandbySpec&) = default;
};

struct BridgeSpec {
  std::string name;
  std::optional<StandbySpec> standby;  // empty: a single bridge
  DdsSpec dds;
  LogSpec log;
  ProgramSpec program;
  std::optional<StoreSpec> store;      // empty: samples are not stored
  std::optional<MetricsSpec> metrics;  // empty: metrics are not served
  ConfigureSpec configure;
  std::vector<BusSpec> buses;
  friend bool operator==(const BridgeSpec&, const BridgeSpec&) = default;
};

}  // namespace fieldcast
