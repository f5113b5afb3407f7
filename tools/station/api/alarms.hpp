// GET /api/alarms: current alarms from the live model; with `from` or `to` the history from the
// store, newest first. Runs on the io thread.
#pragma once

#include "tools/station/api/base/database.hpp"
#include "tools/station/http/route_table.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

// `model` and `database` must outlive the table. `database` is null if the station has no store.
void add_alarm_routes(RouteTable& table, const LiveModel& model, Database* database,
                      std::function<UtcTime()> now);

}  // namespace fieldcast::web
