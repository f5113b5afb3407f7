// GET /api/openapi.yaml: returns tools/station/openapi.yaml, which is compiled into the program.
#pragma once

#include <string_view>

#include "tools/station/http/route_table.hpp"

namespace fieldcast::web {

[[nodiscard]] std::string_view openapi_text();
void add_openapi_routes(RouteTable& table);

}  // namespace fieldcast::web
