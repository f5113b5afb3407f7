#include "core/base/message_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

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

namespace {

constexpr std::size_t kLongestWord = 64;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Optimal string alignment over three rows. REQUIRES: at most kLongestWord characters each.
unsigned edits(std::string_view a, std::string_view b) {
  std::array<std::array<std::uint8_t, kLongestWord + 1>, 3> rows{};
  for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = static_cast<std::uint8_t>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    auto& row = rows[i % 3];
    const auto& above = rows[(i + 2) % 3];
    const auto& before = rows[(i + 1) % 3];
    row[0] = static_cast<std::uint8_t>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      unsigned best = std::min({above[j] + 1u, row[j - 1] + 1u, above[j - 1] + (same ? 0u : 1u)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                           lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) best = std::min(best, before[j - 2] + 1u);
      row[j] = static_cast<std::uint8_t>(best);
    }
  }
  return rows[a.size() % 3][b.size()];
}

}  // namespace

std::string_view near_miss(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.empty() || word.size() > kLongestWord) return {};
  std::string_view best;
  unsigned fewest = static_cast<unsigned>(std::max<std::size_t>(1, word.size() / 3)) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > kLongestWord) continue;
    const unsigned distance = edits(word, candidate);
    if (distance < fewest) {
      fewest = distance;
      best = candidate;
    }
  }
  return best;
}

std::string near_miss(std::string_view word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  return std::string(near_miss(word, std::span(views)));
}

}  // namespace fieldcast
