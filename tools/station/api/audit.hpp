// GET /api/audit: who did what, the newest first. GET /api/users: who may log in, without hashes.
#pragma once

#include "tools/station/api/database.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// `now` on the io thread. Database: null when the station has no store.
void add_audit_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);
void add_user_routes(RouteTable& table, Database* database);

}  // namespace fieldcast::web
