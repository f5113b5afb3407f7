// Makes untrusted text safe for a topic, a terminal, a log and a CSV cell. Pure functions.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

// 1..4; 0 if invalid (RFC 3629: no overlong forms, no surrogates). REQUIRES: not empty.
[[nodiscard]] std::size_t utf8_length(std::string_view text);
[[nodiscard]] bool is_utf8(std::string_view text);

// Printable UTF-8, with \xE4 for invalid bytes and for U+0000..U+001F and U+007F..U+009F.
[[nodiscard]] std::string escaped(std::string_view text);

constexpr std::size_t kMaxPrintable = 4096;  // bytes of a log line

// The code point of the character. REQUIRES: one character of valid UTF-8.
[[nodiscard]] char32_t code_point(std::string_view character);

// False for a control character, an end of line or paragraph, a mark without width and a mark that
// turns the writing direction. REQUIRES: one character of valid UTF-8.
[[nodiscard]] bool is_printable(std::string_view character);

// Replaces other characters and invalid bytes by escapes such as \x1B. Cuts text beyond `limit`
// bytes between two characters and adds "...".
[[nodiscard]] std::string printable(std::string_view text, std::size_t limit = kMaxPrintable);

// "1 device", "2 devices": a number with its noun. Pure.
[[nodiscard]] inline std::string counted(std::size_t count, std::string_view one,
                                         std::string_view many) {
  return std::to_string(count) + ' ' + std::string(count == 1 ? one : many);
}

// The candidate for a "did you mean" hint: the one with the fewest single-character edits (insert,
// delete, replace, swap of neighbours; ignoring case). Empty if that exceeds a third of the word
// (at least one edit is allowed), or the word has more than 64 characters. Pure.
[[nodiscard]] std::string_view near_miss(std::string_view word,
                                         std::span<const std::string_view> candidates);
[[nodiscard]] std::string near_miss(std::string_view word,
                                    const std::vector<std::string>& candidates);

}  // namespace fieldcast
