// GET /metrics: the station's counters in the Prometheus text format 0.0.4. Runs on the io thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/station/api/base/database.hpp"
#include "tools/station/http/route_table.hpp"
#include "tools/station/record/recorder.hpp"

namespace fieldcast::web {

struct Metric {
  const char* name;  // without the prefix "fieldcast_station_"
  bool counter;      // false: gauge
  const char* help;
  double value;
};
[[nodiscard]] std::string metrics_text(const std::vector<Metric>& metrics);

// Returns the metrics of these objects; each pointer may be null.
[[nodiscard]] std::vector<Metric> metrics_of(const Database* database, const Store* store,
                                             const Recorder* recorder);

// `further` returns the metrics of the rest of the program. All arguments must outlive the table.
void add_metrics_routes(RouteTable& table, const Database* database, const Store* store,
                        const Recorder* recorder, std::function<std::vector<Metric>()> further);

}  // namespace fieldcast::web
