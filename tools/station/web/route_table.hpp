// Parses JSON bodies of untrusted requests. Pure.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/http/http_message.hpp"

namespace fieldcast::web {

inline constexpr int kMaxJsonDepth = 8;
inline constexpr std::size_t kUsualBody = 64 * 1024;  // bytes of the body of a request

// Empty if the text is not a JSON object, too deep, not UTF-8 or has a duplicate key.
[[nodiscard]] std::optional<nlohmann::json> parse_object(std::string_view text);

[[nodiscard]] tl::expected<nlohmann::json, HttpResponse> body_of(const HttpRequest& request);

// The text of this name with 1 to `most` bytes; empty for anything else.
[[nodiscard]] std::optional<std::string> text_in(const nlohmann::json& object, const char* name,
                                                 std::size_t most);

enum class Access : std::uint8_t {
  kPublic,    // everybody
  kViewer,    // logged-in users
  kOperator,  // users who may also write
  kEngineer,  // users who may also change configurations and dashboards
};

struct Route {
  Method method;
  std::string path;  // exact
  Access access;
  Handler handler;
  std::size_t body_bytes = kUsualBody;  // at most, for a caller who may use the route
};

[[nodiscard]] bool may_use(Access access, const std::optional<Role>& role);

[[nodiscard]] HttpResponse method_refusal(const std::string& allowed);

// Routes of the station, constant after start. Each states its access; there is no default.
class RouteTable {
 public:
  // REQUIRES: the method and path are new, the path starts with "/", the handler is set.
  void add(Route route);

  // Fails with 404, 405 (with `allow`), 401 (no login) or 403 (role too low). Checks the access
  // first, so that a 405 does not reveal a restricted path.
  [[nodiscard]] tl::expected<const Route*, HttpResponse> find(
      Method method, const std::string& path, const std::optional<Role>& role) const;

  // The header `allow`: "GET, HEAD, OPTIONS". Fails as find() does.
  [[nodiscard]] tl::expected<std::string, HttpResponse> allowed(
      const std::string& path, const std::optional<Role>& role) const;

  [[nodiscard]] std::vector<const Route*> rows() const;  // sorted by path

 private:
  std::map<std::string, std::map<Method, Route>> routes_;
};

}  // namespace fieldcast::web
