// GET /metrics: the station's own counters, as Prometheus reads them (text format 0.0.4). Pure but
// for the functions that are handed in; on the io thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/station/api/database.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

struct Metric {
  const char* name;  // without "fieldcast_station_"
  bool counter;      // else a gauge
  const char* help;
  double value;
};
[[nodiscard]] std::string metrics_text(const std::vector<Metric>& metrics);

// Of what a station has; pointers may be null.
[[nodiscard]] std::vector<Metric> metrics_of(const Database* database, const Store* store,
                                             const Recorder* recorder);

// `further`: the figures of what the program owns besides. All of them outlive the table.
void add_metrics_routes(RouteTable& table, const Database* database, const Store* store,
                        const Recorder* recorder, std::function<std::vector<Metric>()> further);

}  // namespace fieldcast::web
