#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace fieldcast::importing {

// "1.5", "1,5" (decimal comma), "1e-3", "-7", "0x1F". Empty if not finite.
[[nodiscard]] std::optional<double> number_from(std::string_view text);

// A whole number without sign: "100", "0x64", "64h", "100.0". Empty for other text.
[[nodiscard]] std::optional<std::uint64_t> whole_from(std::string_view text);

// Decodes UTF-8, UTF-16 and Windows-1252, with and without a byte order mark. Pure.

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
