// State of the domain from the live model: GET /api/catalogue for the page; /api/channels, buses,
// devices, sessions and bridges for scripts. Runs on the io thread.
#pragma once

#include "tools/station/api/administration.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/model/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kMaxListed = 10'000;  // channels of one response

// The model must outlive the table.
void add_channel_routes(RouteTable& table, const LiveModel& model);

// GET /api/alarms: current alarms from the live model; with `from` or `to` the history from the
// store, newest first. Runs on the io thread.

// `model` and `database` must outlive the table. `database` is null if the station has no store.
void add_alarm_routes(RouteTable& table, const LiveModel& model, Database* database,
                      std::function<UtcTime()> now);

// GET /api/plan?bus=B: the active read plan of a bus; without `bus`, of all buses. On the io
// thread.

// The model must outlive the table.
void add_plan_routes(RouteTable& table, const LiveModel& model);

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
