#pragma once

#include <string>

#include "tools/station/http/http_message.hpp"

namespace fieldcast::web {

// bytes; longer bodies are compressed if the client accepts gzip
inline constexpr std::size_t kWorthCompressing = 2048;
[[nodiscard]] HttpResponse json_response(std::string json, bool compress = false);
[[nodiscard]] HttpResponse no_store();

}  // namespace fieldcast::web
