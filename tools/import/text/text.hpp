// Decodes UTF-8, UTF-16 and Windows-1252, with and without a byte order mark. Pure.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::importing {

struct Decoded {
  std::string text;           // UTF-8 without a byte order mark; lines end with '\n'
  std::string_view encoding;  // human-readable: "UTF-8", "UTF-16", "Windows-1252"
};

// If the bytes are not text, the error names their file type.
[[nodiscard]] tl::expected<Decoded, std::string> decode_text(std::string_view bytes);

// Converts ASCII letters only.
[[nodiscard]] std::string lower(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);  // ignores case
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, char separator);

}  // namespace fieldcast::importing
