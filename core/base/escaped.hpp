// Text of devices and strangers, made fit for a topic, a terminal, a log and a CSV cell. Pure
// functions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fieldcast {

// Bytes of the character at the beginning of the text: 1..4; 0 where it is no UTF-8 (RFC 3629: no
// overlong forms, no surrogates, nothing above U+10FFFF). REQUIRES: not empty.
[[nodiscard]] std::size_t utf8_length(std::string_view text);
[[nodiscard]] bool is_utf8(std::string_view text);

// The text with every byte that is no UTF-8, and every control character (U+0000..U+001F,
// U+007F..U+009F), as \xE4. What comes out is printable UTF-8.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace fieldcast
