// GET /api/audit: the audit log, newest first. GET /api/users: the users without their hashes.
#pragma once

#include "tools/station/api/base/database.hpp"
#include "tools/station/http/route_table.hpp"

namespace fieldcast::web {

// `now` is called on the io thread. `database` is null if the station has no store.
void add_audit_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);
void add_user_routes(RouteTable& table, Database* database);

}  // namespace fieldcast::web
