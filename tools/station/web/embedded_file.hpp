// A file of the page that is compiled into the program.
#pragma once

#include <span>
#include <string_view>

namespace fieldcast::web {

struct EmbeddedFile {
  std::string_view path;          // path of the request: "/app.js"; "/" for the index
  std::string_view content_type;  // "text/javascript; charset=utf-8"
  std::string_view gzip;          // compressed content (RFC 1952)
  std::string_view etag;          // with quotes; changes with the content
};

// Defined in the library fieldcast_station_page. Static lifetime.
[[nodiscard]] std::span<const EmbeddedFile> page_files();

}  // namespace fieldcast::web
