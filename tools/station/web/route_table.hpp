// The routes of the station: one row each, filled at the start and constant from then on. What is
// not in the table is refused, and each row says who may use it: there is no default.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

enum class Access : std::uint8_t {
  kPublic,    // everybody
  kViewer,    // who is logged in
  kOperator,  // who may also write
};

struct Route {
  Method method;
  std::string path;  // exact: "/api/history"
  Access access;
  Handler handler;
};

// Whether this caller may use it; nobody is logged in: nothing.
[[nodiscard]] bool may_use(Access access, const std::optional<Role>& role);

// 405 with the header `allow`.
[[nodiscard]] HttpResponse method_refusal(const std::string& allowed);

class RouteTable {
 public:
  // REQUIRES: no such method and path yet, a path from "/", a handler.
  void add(Route route);

  // The row, or the response that refuses: 404, 405 (with `allow`), 401 (nobody is logged in), 403
  // (the role is too low). A path that only logged-in callers may use is not told from one that
  // does not exist by what a 405 says: access is checked first.
  [[nodiscard]] tl::expected<const Route*, HttpResponse> find(
      Method method, const std::string& path, const std::optional<Role>& role) const;

  // The header `allow` of that path: "GET, HEAD, OPTIONS". Refuses as find() does.
  [[nodiscard]] tl::expected<std::string, HttpResponse> allowed(
      const std::string& path, const std::optional<Role>& role) const;

  [[nodiscard]] std::vector<const Route*> rows() const;  // by path

 private:
  std::map<std::string, std::map<Method, Route>> routes_;
};

}  // namespace fieldcast::web
