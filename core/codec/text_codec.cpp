#include "core/codec/text_codec.hpp"

#include <algorithm>

#include "core/base/escaped.hpp"

namespace fieldcast {
namespace {

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// A byte of Latin-1 is the code point of its character; 80..9F are controls.
std::string latin1_to_utf8(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0xA0) {
      text += escaped({&c, 1});
    } else {
      text += static_cast<char>(0xC0u | byte >> 6);
      text += static_cast<char>(0x80u | (byte & 0x3Fu));
    }
  }
  return text;
}

std::optional<std::string> latin1_from_utf8(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (length == 0 || length > 2 || (length == 2 && first > 0xC3)) return std::nullopt;
    bytes += length == 1 ? text[0]
                         : static_cast<char>((first & 0x03u) << 6 |
                                             (static_cast<unsigned char>(text[1]) & 0x3Fu));
    text.remove_prefix(length);
  }
  return bytes;
}

class PlainTextCodec final : public TextCodec {
 public:
  std::string to_utf8(Charset charset, std::string_view bytes) override {
    if (charset == Charset::kUtf8) return escaped(bytes);
    if (charset == Charset::kLatin1) return latin1_to_utf8(bytes);
    std::string text;
    // Byte by byte, so that it is never treated as UTF-8.
    for (const char& c : bytes) text += escaped({&c, 1});
    return text;
  }
  std::optional<std::string> from_utf8(Charset charset, std::string_view text) override {
    if (charset == Charset::kLatin1) return latin1_from_utf8(text);
    const bool fits = charset == Charset::kUtf8 ? is_utf8(text) : is_ascii(text);
    return fits ? std::optional<std::string>(text) : std::nullopt;
  }
};

}  // namespace

std::string_view to_text(Charset charset) {
  switch (charset) {
    case Charset::kUtf8: return "utf-8";
    case Charset::kLatin1: return "latin-1";
    case Charset::kGbk: return "gbk";
    case Charset::kShiftJis: return "shift-jis";
  }
  return "?";
}

TextCodec& plain_text_codec() {
  static PlainTextCodec codec;
  return codec;
}

}  // namespace fieldcast
