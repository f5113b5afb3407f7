// The routes of the page's files, which are part of the program: no file is ever found by its path.
#pragma once

#include <span>

#include "tools/station/web/embedded_file.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

// One public route for each file; /embed is the index too. The bytes are kept compressed; a client
// that takes no gzip gets them unpacked.
void add_page_routes(RouteTable& routes, std::span<const EmbeddedFile> files);

}  // namespace fieldcast::web
