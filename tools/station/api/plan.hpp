// GET /api/plan?bus=B: the read plan that is in force on a bus, as its bridge tells it. Without
// `bus` those of all buses. On the io thread.
#pragma once

#include "tools/station/live/live_model.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// The model outlives the table.
void add_plan_routes(RouteTable& table, const LiveModel& model);

}  // namespace fieldcast::web
