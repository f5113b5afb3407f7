// Converts texts between the character set of a device and UTF-8.
//
// Core knows ASCII, UTF-8 and Latin-1; character sets that need tables come from a library, through
// this interface. Each bus has an object of its own, used on the bus's thread.
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
  // Printable UTF-8: what is no character of the set, and control characters, stand as \xE4.
  [[nodiscard]] virtual std::string to_utf8(Charset charset, std::string_view bytes) = 0;
  // The bytes of a text; nothing when it is no UTF-8, or the set lacks one of its characters.
  [[nodiscard]] virtual std::optional<std::string> from_utf8(Charset charset,
                                                             std::string_view text) = 0;
};

// Without a library: of GBK and Shift-JIS the ASCII characters alone. Any thread.
[[nodiscard]] TextCodec& plain_text_codec();

}  // namespace fieldcast
