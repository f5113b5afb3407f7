// GET /api/export: the history of any number of channels as CSV or JSON lines, streamed.
#pragma once

#include "tools/station/api/database.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// At a time; one more is refused.
inline constexpr int kMaxExports = 4;

// `now` on the io thread. Database: null when the station has no store; it outlives the streams'
// questions.
void add_export_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);

}  // namespace fieldcast::web
