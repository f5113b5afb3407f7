#include "tools/cli/text/cell_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/message_text.hpp"
#include "tools/cli/text/character_width.hpp"

namespace fieldcast::cli {
namespace {

bool is_ascii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// REQUIRES: valid UTF-8, not empty. Removes the first character from the text.
char32_t take_character(std::string_view& text) {
  const std::size_t length = std::max<std::size_t>(1, utf8_length(text));
  auto code = static_cast<unsigned char>(text[0]) & (length == 1 ? 0x7Fu : 0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length && i < text.size(); ++i)
    code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  text.remove_prefix(std::min(length, text.size()));
  return code;
}

// Right-to-left letters (Unicode Standard Annex 9). Direction marks are not is_printable().
bool is_right_to_left(char32_t c) {
  const auto in = [c](char32_t first, char32_t last) { return c >= first && c <= last; };
  return in(0x0590, 0x08FF) || in(0xFB1D, 0xFDFF) || in(0xFE70, 0xFEFF) || in(0x10800, 0x10FFF) ||
         in(0x1E800, 0x1EFFF);
}

constexpr int kMostMarks = 2;  // on one character

}  // namespace

std::string shown(std::string_view text) {
  const std::string plain = escaped(text);
  if (is_ascii(plain)) return plain;
  const WidthsOfUnicode widths;
  std::string out;
  int marks = kMostMarks;  // none before the first character
  for (std::string_view rest = plain; !rest.empty();) {
    const std::string_view before = rest;
    const char32_t c = take_character(rest);
    const std::string_view character = before.substr(0, before.size() - rest.size());
    const bool escape = is_right_to_left(c) || !is_printable(character);
    const int width = escape ? -1 : widths.of(c);
    if (width < 0 || (width == 0 && marks == kMostMarks)) {
      out += fmt::format("\\u{{{:X}}}", static_cast<std::uint32_t>(c));
      continue;
    }
    marks = width == 0 ? marks + 1 : 0;
    out += character;
  }
  return out;
}

std::size_t columns_of(std::string_view shown) {
  if (is_ascii(shown)) return shown.size();
  const WidthsOfUnicode widths;
  std::size_t columns = 0;
  while (!shown.empty())
    columns += static_cast<std::size_t>(std::max(0, widths.of(take_character(shown))));
  return columns;
}

std::string cut(std::string_view shown, std::size_t columns) {
  if (is_ascii(shown)) return std::string(shown.substr(0, columns));
  const WidthsOfUnicode widths;
  std::size_t used = 0;
  std::string_view rest = shown;
  while (!rest.empty()) {
    std::string_view after = rest;
    const auto width = static_cast<std::size_t>(std::max(0, widths.of(take_character(after))));
    if (used + width > columns) break;
    used += width;
    rest = after;
  }
  return std::string(shown.substr(0, shown.size() - rest.size()));
}

std::string fitted(std::string_view shown, std::size_t columns, Align align) {
  if (columns == 0) return {};
  const std::size_t wide = columns_of(shown);
  std::string text = wide <= columns ? std::string(shown) : cut(shown, columns - 1) + '~';
  const std::string pad(columns - std::min(columns, columns_of(text)), ' ');
  return align == Align::kRight ? pad + text : text + pad;
}

std::vector<std::string> wrapped(std::string_view shown, std::size_t columns, std::size_t indent) {
  std::vector<std::string> lines;
  columns = std::max<std::size_t>(columns, 1);
  indent = std::min(indent, columns - 1);
  while (lines.empty() || !shown.empty()) {
    const std::string before(lines.empty() ? 0 : indent, ' ');
    std::string line = cut(shown, columns - before.size());
    // a wide character in a single column
    if (line.empty() && !shown.empty()) line = cut(shown, 2);
    if (line.size() < shown.size() && shown[line.size()] != ' ') {
      if (const auto space = line.rfind(' '); space != std::string::npos && space != 0)
        line.resize(space);
    }
    shown.remove_prefix(line.size());
    shown.remove_prefix(std::min(shown.find_first_not_of(' '), shown.size()));
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(before + line);
  }
  return lines;
}

}  // namespace fieldcast::cli
