// The bytes of a response before its body: HTTP/1.1, RFC 9112. Pure.
#pragma once

#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

struct HeadOptions {
  UtcTime date;
  bool keep_alive = true;
  // Of the body; nothing: it comes in chunks, or, for HTTP/1.0, ends with the connection.
  std::optional<std::size_t> length;
  bool chunked = false;
};

// A name or value with an end of line in it is left out: it would begin another header.
[[nodiscard]] std::string response_head(const HttpResponse& response, const HeadOptions& options);

[[nodiscard]] std::string_view reason_of(unsigned status);  // "Not Found"
// A status that never has a body: 204, 304.
[[nodiscard]] bool has_no_body(unsigned status);

}  // namespace fieldcast::web
