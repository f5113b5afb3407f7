// GET /api/plan?bus=B: the active read plan of a bus; without `bus`, of all buses. On the io
// thread.
#pragma once

#include "tools/station/http/route_table.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

// The model must outlive the table.
void add_plan_routes(RouteTable& table, const LiveModel& model);

}  // namespace fieldcast::web
