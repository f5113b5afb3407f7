// Pure.
#pragma once

#include <string>

namespace fieldcast {

// One field by RFC 4180, 2.6 and 2.7; control characters are escaped.
[[nodiscard]] std::string csv_field(const std::string& raw);

}  // namespace fieldcast
