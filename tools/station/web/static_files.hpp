// Routes of the page's files, which are compiled into the program. No file is read by its path.
#pragma once

#include <span>

#include "tools/station/http/embedded_file.hpp"
#include "tools/station/http/route_table.hpp"

namespace fieldcast::web {

// Adds a public route for each file; /embed is also the index. Files are stored compressed.
void add_page_routes(RouteTable& routes, std::span<const EmbeddedFile> files);

}  // namespace fieldcast::web
