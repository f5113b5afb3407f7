#include "core/base/escaped.hpp"

namespace fieldcast {
namespace {

unsigned at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
}
bool continues(unsigned byte) { return (byte & 0xC0u) == 0x80u; }

bool is_control(std::string_view character) {
  const unsigned first = at(character, 0);
  return first < 0x20 || first == 0x7F || (first == 0xC2 && at(character, 1) < 0xA0);
}

}  // namespace

// RFC 3629, 4.
std::size_t utf8_length(std::string_view text) {
  const unsigned first = at(text, 0), second = at(text, 1);
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4 || !continues(second)) return 0;
  if (first < 0xE0) return 2;
  if (!continues(at(text, 2))) return 0;
  if (first < 0xF0) {
    const bool overlong = first == 0xE0 && second < 0xA0;
    const bool surrogate = first == 0xED && second >= 0xA0;
    return overlong || surrogate ? 0 : 3;
  }
  const bool overlong = first == 0xF0 && second < 0x90;
  const bool above = first == 0xF4 && second >= 0x90;
  return overlong || above || !continues(at(text, 3)) ? 0 : 4;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string escaped(std::string_view text) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view character = text.substr(0, length == 0 ? 1 : length);
    if (length != 0 && !is_control(character)) {
      out += character;
    } else {
      for (const char c : character) {
        const auto byte = static_cast<unsigned char>(c);
        out.append("\\x") += kDigits[byte >> 4];
        out += kDigits[byte & 0xFu];
      }
    }
    text.remove_prefix(character.size());
  }
  return out;
}

}  // namespace fieldcast
