// GET /api/export: streams the history of any number of channels as CSV or JSON lines.
#pragma once

#include "tools/station/api/base/database.hpp"
#include "tools/station/http/route_table.hpp"

namespace fieldcast::web {

inline constexpr int kMaxExports = 4;

// `now` runs on the io thread. `database`: null without a store; outlives the exports.
void add_export_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);

}  // namespace fieldcast::web
