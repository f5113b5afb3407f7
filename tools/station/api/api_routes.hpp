// Adds all routes under /api, and /metrics.
#pragma once

#include "tools/station/api/metrics.hpp"
#include "tools/station/live/command_sink.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// Objects that the routes use; all of them must outlive the table. Pointers are null if the station
// has no store or records nothing.
struct ApiNeeds {
  const LiveModel& model;
  CommandSink& commands;
  Database* database;
  const Store* store;
  const Recorder* recorder;
  std::function<UtcTime()> now;
  std::function<std::vector<Metric>()> metrics;  // counters of the rest of the program
};

void add_routes(RouteTable& routes, const ApiNeeds& needs);

}  // namespace fieldcast::web
