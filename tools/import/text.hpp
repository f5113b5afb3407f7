// Bytes of a file as UTF-8 text. Spreadsheets and editors save UTF-8 with and without a byte order
// mark, UTF-16 of both orders, and the Windows code page of western Europe (1252). Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::importing {

struct Decoded {
  std::string text;           // UTF-8, without a byte order mark, lines ended by '\n'
  std::string_view encoding;  // for people: "UTF-8", "UTF-16", "Windows-1252"
};

// The error says what the bytes are, if they are no text.
[[nodiscard]] tl::expected<Decoded, std::string> decode_text(std::string_view bytes);

// ASCII letters in lower case, everything else as it is.
[[nodiscard]] std::string lower(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);  // without case
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

}  // namespace fieldcast::importing
