// Converts untrusted text to one line that is safe for a log or a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fieldcast {

constexpr std::size_t kMaxPrintable = 4096;  // bytes of a log line

// The code point of the character. REQUIRES: one character of valid UTF-8.
[[nodiscard]] char32_t code_point(std::string_view character);

// False for a control character, an end of line or paragraph, a mark without width and a mark that
// turns the writing direction. REQUIRES: one character of valid UTF-8.
[[nodiscard]] bool is_printable(std::string_view character);

// Replaces other characters and invalid bytes by escapes such as \x1B. Cuts text beyond `limit`
// bytes between two characters and adds "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t limit = kMaxPrintable);

}  // namespace fieldcast
