#include "tools/station/web/route_table.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "bridge/base/check.hpp"

namespace fieldcast::web {

std::optional<nlohmann::json> parse_object(std::string_view text) {
  using Event = nlohmann::json::parse_event_t;
  bool fault = false;
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, Event event, const nlohmann::json& value) {
    if (depth > kMaxJsonDepth) fault = true;
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(value.get<std::string>()).second) fault = true;
    return !fault;
  };
  nlohmann::json parsed = nlohmann::json::parse(text, watch, /*allow_exceptions=*/false);
  if (fault || !parsed.is_object()) return std::nullopt;
  return parsed;
}

tl::expected<nlohmann::json, HttpResponse> body_of(const HttpRequest& request) {
  auto parsed = parse_object(request.body);
  if (!parsed) {
    return tl::make_unexpected(
        error_response(400, "the body is no JSON object", "see /api/openapi.yaml for its fields"));
  }
  return *std::move(parsed);
}

std::optional<std::string> text_in(const nlohmann::json& object, const char* name,
                                   std::size_t most) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_string()) return std::nullopt;
  const auto& text = found->get_ref<const std::string&>();
  return text.empty() || text.size() > most ? std::nullopt : std::optional(text);
}

namespace {

HttpResponse refusal(bool logged_in) {
  if (logged_in)
    return error_response(403, "not allowed", "your role may not do this; ask for another role");
  return error_response(401, "login required", "log in with POST /api/login");
}

}  // namespace

HttpResponse method_refusal(const std::string& allowed) {
  HttpResponse refused = error_response(405, "method not allowed", "allowed here: " + allowed);
  refused.headers.emplace_back("allow", allowed);
  return refused;
}

bool may_use(Access access, const std::optional<Role>& role) {
  switch (access) {
    case Access::kPublic: return true;
    case Access::kViewer: return role && may(*role, Role::kViewer);
    case Access::kOperator: return role && may(*role, Role::kOperator);
    case Access::kEngineer: return role && may(*role, Role::kEngineer);
  }
  return false;
}

void RouteTable::add(Route route) {
  FIELDCAST_CHECK(route.path.starts_with('/') && route.handler);
  const std::string path = route.path;
  const Method method = route.method;
  const bool added = routes_[path].emplace(method, std::move(route)).second;
  FIELDCAST_CHECK(added);
}

tl::expected<std::string, HttpResponse> RouteTable::allowed(const std::string& path,
                                                            const std::optional<Role>& role) const {
  const auto at = routes_.find(path);
  if (at == routes_.end())
    return tl::make_unexpected(
        error_response(404, "no such page", "the addresses are in /api/openapi.yaml"));
  const bool usable = std::ranges::any_of(
      at->second, [&](const auto& each) { return may_use(each.second.access, role); });
  if (!usable) return tl::make_unexpected(refusal(role.has_value()));
  std::string methods;
  for (const auto& [each, route] : at->second) {
    methods += to_text(each);
    methods += each == Method::kGet ? ", HEAD, " : ", ";
  }
  return methods + "OPTIONS";
}

tl::expected<const Route*, HttpResponse> RouteTable::find(Method method, const std::string& path,
                                                          const std::optional<Role>& role) const {
  if (const auto at = routes_.find(path); at != routes_.end()) {
    const auto row = at->second.find(method);
    if (row != at->second.end()) {
      if (!may_use(row->second.access, role)) return tl::make_unexpected(refusal(role.has_value()));
      return &row->second;
    }
  }
  const auto methods = allowed(path, role);
  if (!methods) return tl::make_unexpected(methods.error());
  return tl::make_unexpected(method_refusal(*methods));
}

std::vector<const Route*> RouteTable::rows() const {
  std::vector<const Route*> rows;
  for (const auto& [path, methods] : routes_) {
    for (const auto& [method, route] : methods) rows.push_back(&route);
  }
  return rows;
}

}  // namespace fieldcast::web
