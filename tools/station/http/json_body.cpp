#include "tools/station/http/json_body.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

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

}  // namespace fieldcast::web
