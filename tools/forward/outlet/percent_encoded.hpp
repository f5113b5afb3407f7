// Names in URLs. Pure.
#pragma once

#include <string>
#include <string_view>

namespace fieldcast::forward {

// RFC 3986, 2.1: each byte that is not unreserved becomes "%2F".
[[nodiscard]] std::string percent_encoded(std::string_view text);

}  // namespace fieldcast::forward
