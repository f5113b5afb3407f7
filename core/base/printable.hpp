// Text from outside (a station's name, a login, a device's answer, another program's message) as
// one line that is safe for a log or a terminal: it holds no control sequence and no end of line.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fieldcast {

constexpr std::size_t kMaxPrintable = 4096;  // bytes of a line of the log

// The code point of the character. REQUIRES: one character of valid UTF-8.
[[nodiscard]] char32_t code_point(std::string_view character);

// False for a control character, an end of line or paragraph, a mark without width and a mark that
// turns the writing direction. REQUIRES: one character of valid UTF-8.
[[nodiscard]] bool is_printable(std::string_view character);

// The text in UTF-8 with \n, \r, \t, \x1B or \u202E in place of everything that does not stand for
// itself: control characters, bytes that are no UTF-8, and marks that change the line or its
// direction. What is longer than `limit` bytes is cut between two characters and ends in "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t limit = kMaxPrintable);

}  // namespace fieldcast
