// Converts texts between the character set of a device and UTF-8. Core supports ASCII, UTF-8 and
// Latin-1; a library adds other sets through this interface. Each bus has its own object, used on
// its thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fieldcast {

enum class Charset : std::uint8_t { kUtf8, kLatin1, kGbk, kShiftJis };
[[nodiscard]] std::string_view to_text(Charset charset);  // "utf-8", "latin-1", "gbk", "shift-jis"

class TextCodec {
 public:
  virtual ~TextCodec() = default;
  // Printable UTF-8; invalid bytes and control characters are written as \xE4.
  [[nodiscard]] virtual std::string to_utf8(Charset charset, std::string_view bytes) = 0;
  // Empty if the text is not UTF-8, or the set lacks a character.
  [[nodiscard]] virtual std::optional<std::string> from_utf8(Charset charset,
                                                             std::string_view text) = 0;
};

// Supports only the ASCII characters of GBK and Shift-JIS. Any thread.
[[nodiscard]] TextCodec& plain_text_codec();

}  // namespace fieldcast
