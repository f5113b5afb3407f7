// Makes untrusted text safe for a topic, a terminal, a log and a CSV cell. Pure functions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fieldcast {

// 1..4; 0 if invalid (RFC 3629: no overlong forms, no surrogates). REQUIRES: not empty.
[[nodiscard]] std::size_t utf8_length(std::string_view text);
[[nodiscard]] bool is_utf8(std::string_view text);

// Printable UTF-8, with \xE4 for invalid bytes and for U+0000..U+001F and U+007F..U+009F.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace fieldcast
