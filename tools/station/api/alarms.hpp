// GET /api/alarms: the alarms that are there now, from the live model; with `from` or `to` what
// happened to alarms, from the store, the newest first. On the io thread.
#pragma once

#include "tools/station/api/database.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// Model and database outlive the table. Database: null when the station has no store.
void add_alarm_routes(RouteTable& table, const LiveModel& model, Database* database,
                      std::function<UtcTime()> now);

}  // namespace fieldcast::web
