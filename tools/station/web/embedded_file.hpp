// A file of the page that is part of the program.
#pragma once

#include <span>
#include <string_view>

namespace fieldcast::web {

struct EmbeddedFile {
  std::string_view path;          // of the request: "/app.js"; "/" for the index
  std::string_view content_type;  // "text/javascript; charset=utf-8"
  std::string_view gzip;          // its bytes, compressed (RFC 1952)
  std::string_view etag;          // with its quotes; changes with the bytes
};

// Of the library fieldcast_station_page. Lives as long as the program.
[[nodiscard]] std::span<const EmbeddedFile> page_files();

}  // namespace fieldcast::web
