#include "core/base/printable.hpp"

#include "core/base/escaped.hpp"

namespace fieldcast {
namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";
constexpr std::string_view kCut = "...";

std::string spelled(char32_t code) {
  switch (code) {
    case '\n': return "\\n";
    case '\r': return "\\r";
    case '\t': return "\\t";
    default: break;
  }
  if (code < 0x80) return {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
  std::string text = "\\u";
  for (int shift = 12; shift >= 0; shift -= 4) text += kDigits[code >> shift & 15];
  return text;
}

}  // namespace

char32_t code_point(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  char32_t code = byte(0);
  if (character.size() > 1) code &= 0xFFu >> (character.size() + 1);
  for (std::size_t i = 1; i < character.size(); ++i) code = code << 6 | (byte(i) & 0x3Fu);
  return code;
}

// Controls of ASCII and of Latin-1 (some terminals obey U+009B as they do ESC [), ends of lines and
// paragraphs, and the marks that turn the direction of text (Unicode 15, 23.2 and UAX #9).
bool is_printable(std::string_view character) {
  const char32_t code = code_point(character);
  if (code < 0x20 || (code >= 0x7F && code < 0xA0)) return false;
  if (code == 0x061C || code == 0xFEFF) return false;
  if (code >= 0x200B && code <= 0x200F) return false;
  return !(code >= 0x2028 && code <= 0x202E) && !(code >= 0x2060 && code <= 0x206F);
}

std::string printable(std::string_view text, std::size_t limit) {
  std::string out;
  std::size_t whole = 0;  // bytes of `out` that leave space for kCut
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view character = text.substr(0, length);
    if (length == 0) {
      out += escaped(text.substr(0, 1));
    } else if (is_printable(character)) {
      out += character;
    } else {
      out += spelled(code_point(character));
    }
    if (out.size() > limit) {
      out.resize(whole);
      return out += kCut;
    }
    if (out.size() + kCut.size() <= limit) whole = out.size();
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace fieldcast
