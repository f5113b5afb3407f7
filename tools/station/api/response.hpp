// Responses that several resources give. Pure.
#pragma once

#include <string>

#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

// Longer ones are compressed for who takes gzip.
inline constexpr std::size_t kWorthCompressing = 2048;  // bytes
[[nodiscard]] HttpResponse json_response(std::string json, bool compress = false);
// The station has no store, and the resource needs one.
[[nodiscard]] HttpResponse no_store();

}  // namespace fieldcast::web
