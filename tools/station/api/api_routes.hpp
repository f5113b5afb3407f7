#pragma once

#include "tools/station/api/metrics.hpp"
#include "tools/station/http/route_table.hpp"
#include "tools/station/live/command_sink.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

// Must outlive the table. Pointers are null without a store or recorder.
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
