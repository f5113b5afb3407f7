// Replaces the page if built with -DFIELDCAST_STATION_PAGE=OFF.
#include <string>

#include "bridge/http/http_message.hpp"
#include "tools/station/web/embedded_file.hpp"

namespace fieldcast::web {

std::span<const EmbeddedFile> page_files() {
  static const std::string kDocument = packed(
      R"(<!doctype html><html lang="en"><meta charset="utf-8"><title>Fieldcast</title>
<p>This station was built without its page. Build it again with -DFIELDCAST_STATION_PAGE=ON (needs
npm: tools/install.sh build). The API answers under <a href="/api/me">/api</a>.)");
  static const EmbeddedFile kFiles[] = {
      {"/", "text/html; charset=utf-8", kDocument, "\"no-page\""}};
  return kFiles;
}

}  // namespace fieldcast::web
