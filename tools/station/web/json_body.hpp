// The JSON of a request's body, from anybody. Pure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

inline constexpr int kMaxJsonDepth = 8;

// An object; nothing: no JSON, no object, too deep, no UTF-8, or a key twice.
[[nodiscard]] std::optional<nlohmann::json> parse_object(std::string_view text);

// As above, with the response that refuses: 400.
[[nodiscard]] tl::expected<nlohmann::json, HttpResponse> body_of(const HttpRequest& request);

}  // namespace fieldcast::web
