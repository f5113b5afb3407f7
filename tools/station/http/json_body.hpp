// Parses JSON bodies of untrusted requests. Pure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/station/http/http_message.hpp"

namespace fieldcast::web {

inline constexpr int kMaxJsonDepth = 8;

// Empty if the text is not a JSON object, too deep, not UTF-8 or has a duplicate key.
[[nodiscard]] std::optional<nlohmann::json> parse_object(std::string_view text);

// Like parse_object(), but fails with the response 400.
[[nodiscard]] tl::expected<nlohmann::json, HttpResponse> body_of(const HttpRequest& request);

}  // namespace fieldcast::web
