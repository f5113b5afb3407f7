// Encodes the status line and the headers of a response (HTTP/1.1, RFC 9112). Pure.
#pragma once

#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/station/http/http_message.hpp"

namespace fieldcast::web {

struct HeadOptions {
  UtcTime date;
  bool keep_alive = true;
  // Of the body. Empty for a chunked body, or, in HTTP/1.0, one that ends with the connection.
  std::optional<std::size_t> length;
  bool chunked = false;
};

// Omits a name or value with a line break, because it would start another header.
[[nodiscard]] std::string response_head(const HttpResponse& response, const HeadOptions& options);

[[nodiscard]] std::string_view reason_of(unsigned status);  // "Not Found"
// Statuses that never have a body: 204, 304.
[[nodiscard]] bool has_no_body(unsigned status);

}  // namespace fieldcast::web
