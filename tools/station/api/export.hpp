// GET /api/export: streams the history of any number of channels as CSV or JSON lines.
#pragma once

#include "tools/station/api/database.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// Exports that run at the same time; a further one is refused.
inline constexpr int kMaxExports = 4;

// `now` is called on the io thread. `database` is null if the station has no store; it must outlive
// the queries of all exports.
void add_export_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);

}  // namespace fieldcast::web
