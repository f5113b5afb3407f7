// Responses that several resources return. Pure.
#pragma once

#include <string>

#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

// bytes; longer bodies are compressed if the client accepts gzip
inline constexpr std::size_t kWorthCompressing = 2048;
[[nodiscard]] HttpResponse json_response(std::string json, bool compress = false);
// Refuses a resource that needs a store if the station has none.
[[nodiscard]] HttpResponse no_store();

}  // namespace fieldcast::web
