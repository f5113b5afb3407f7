// HTTP requests and responses for the route handlers, without sockets and Beast.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/access/login.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

enum class Method : std::uint8_t { kGet, kPost, kDelete };
[[nodiscard]] std::string_view to_text(Method method);  // "GET"
[[nodiscard]] std::optional<Method> method_from(std::string_view text);

// The client of a request. `user` is empty on a public route without a login.
struct Caller {
  std::string user;
  Role role = Role::kViewer;
  std::string peer;  // address without the port
};

using TextPairs = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  Method method = Method::kGet;
  std::string path;  // decoded, without the query
  TextPairs query;   // decoded, in the order of the query
  std::string body;  // UTF-8 if it is JSON; at most 64 KiB
  bool accepts_gzip = false;
  std::string if_none_match;  // raw header
  std::string login;          // secret of the login cookie; empty: no cookie

  [[nodiscard]] std::optional<std::string> parameter(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> parameters(std::string_view name) const;
};

// A request as received, before any check.
struct RawRequest {
  std::string method, target;
  std::vector<std::string> hosts;  // all Host headers
  std::optional<std::string> origin;
  std::string content_type, cookie, accept, accept_encoding, if_none_match;
  std::string subprotocols;  // of a WebSocket
  std::string body;
  std::string peer;  // address without the port
};

// The next piece of a streamed body; empty at the end of the body.
using Piece = std::optional<std::string>;

struct HttpResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  // Used instead of `body` if set: bytes shared by many responses.
  std::shared_ptr<const std::string> shared_body;
  // Used instead of both if set. Called on the io thread for each next piece, after the client has
  // received the last one; it passes one piece to its argument, immediately or later on the io
  // thread. Destroyed when the client disconnects.
  std::function<void(std::function<void(Piece)>)> next;
  TextPairs headers;   // further headers: content-encoding, etag, retry-after, ...
  bool close = false;  // ends the connection after this response
};

// {"error":"..","hint":".."}: what is wrong and what to do. Contains no internals of the program.
[[nodiscard]] HttpResponse error_response(unsigned status, std::string_view error,
                                          std::string_view hint);

// Call once, on the io thread, immediately or later. A disconnected client is not an error.
using Reply = std::function<void(HttpResponse)>;
// Runs on the io thread and must not block it.
using Handler = std::function<void(const HttpRequest&, const Caller&, Reply)>;

// Decodes a request target. Empty without "/", or with a bad escape, a zero or over 64 parameters.
struct Target {
  std::string path;
  TextPairs query;
};
[[nodiscard]] std::optional<Target> parse_target(std::string_view text);

// Encodes the status line and the headers of a response (HTTP/1.1, RFC 9112). Pure.
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

// Gzip (RFC 1952) for bodies. Throws only std::bad_alloc.
[[nodiscard]] std::string packed(std::string_view text);
// REQUIRES: the bytes are output of packed().
[[nodiscard]] std::string unpacked(std::string_view gzip);

class GzipPieces {
 public:
  GzipPieces();
  ~GzipPieces();
  GzipPieces(const GzipPieces&) = delete;
  GzipPieces& operator=(const GzipPieces&) = delete;

  // Returns the bytes to send for this piece; may be empty, because zlib buffers.
  [[nodiscard]] std::string put(std::string_view text);
  [[nodiscard]] std::string finish();  // returns the rest; call once

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
