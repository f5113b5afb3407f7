// All resources under /api, and /metrics: one call for each of them.
#pragma once

#include "tools/station/api/metrics.hpp"
#include "tools/station/live/command_sink.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// What the resources need; all of it outlives the table. Pointers may be null: there is no store,
// nothing is recorded.
struct ApiNeeds {
  const LiveModel& model;
  CommandSink& commands;
  Database* database;
  const Store* store;
  const Recorder* recorder;
  std::function<UtcTime()> now;
  std::function<std::vector<Metric>()> metrics;  // of what the program owns besides
};

void add_routes(RouteTable& routes, const ApiNeeds& needs);

}  // namespace fieldcast::web
