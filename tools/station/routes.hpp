#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bridge/store/store.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/http/route_table.hpp"
#include "tools/station/live/live_domain.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/web/http_server.hpp"

namespace fieldcast::web {

// Must outlive the table. Pointers are null without a store or recorder.
struct RouteNeeds {
  LiveDomain& domain;
  Database* database;
  Store* store;
  Recorder* recorder;
  const HttpServer& server;
  std::function<UtcTime()> now;
};

void add_api_routes(RouteTable& routes, const RouteNeeds& needs);

}  // namespace fieldcast::web
