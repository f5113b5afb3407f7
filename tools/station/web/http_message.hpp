// A request and its response as values: what the handlers of routes see of HTTP. No socket, no
// Beast.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/access/role.hpp"

namespace fieldcast::web {

enum class Method : std::uint8_t { kGet, kPost, kDelete };
[[nodiscard]] std::string_view to_text(Method method);  // "GET"
[[nodiscard]] std::optional<Method> method_from(std::string_view text);

// Who asks. On a public route nobody need be logged in: then the user is empty.
struct Caller {
  std::string user;
  Role role = Role::kViewer;
  std::string peer;  // the address without the port
};

using TextPairs = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  Method method = Method::kGet;
  std::string path;  // decoded, without the query
  TextPairs query;   // decoded, in order
  std::string body;  // UTF-8 when it is JSON; at most 64 KiB
  bool accepts_gzip = false;
  std::string if_none_match;  // the header, as it came
  std::string login;          // the token of the login's cookie; empty: none came

  // The value of the first parameter of that name, and of all of them.
  [[nodiscard]] std::optional<std::string> parameter(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> parameters(std::string_view name) const;
};

// The next piece of a streamed body; nothing: the body has ended.
using Piece = std::optional<std::string>;

struct HttpResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  // Instead of `body`, when it is set: bytes made once for many responses.
  std::shared_ptr<const std::string> shared_body;
  // Instead of both, when it is set: asked for a piece when the client has taken the last one, and
  // destroyed when the client is gone. Called on the io thread; it answers there, once, at any
  // later time.
  std::function<void(std::function<void(Piece)>)> next;
  TextPairs headers;  // further ones: content-encoding, etag, retry-after, ...
};

// {"error":"..","hint":".."}: what is wrong, and what to do about it. No detail of the program.
[[nodiscard]] HttpResponse error_response(unsigned status, std::string_view error,
                                          std::string_view hint);

// To be called once, on the io thread, at once or later. A client that is gone is no fault.
using Reply = std::function<void(HttpResponse)>;
// Runs on the io thread and must not block it.
using Handler = std::function<void(const HttpRequest&, const Caller&, Reply)>;

// The path and the query of a request's target ("/a%20b?c=1&c=2"); nothing when it is none: not
// from "/", a bad escape, a zero byte, more than 64 parameters.
struct Target {
  std::string path;
  TextPairs query;
};
[[nodiscard]] std::optional<Target> parse_target(std::string_view text);

}  // namespace fieldcast::web
