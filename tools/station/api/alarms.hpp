// GET /api/alarms: current alarms from the live model; with `from` or `to` the history from the
// store, newest first. Runs on the io thread.
#pragma once

#include "tools/station/api/database.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// `model` and `database` must outlive the table. `database` is null if the station has no store.
void add_alarm_routes(RouteTable& table, const LiveModel& model, Database* database,
                      std::function<UtcTime()> now);

}  // namespace fieldcast::web
