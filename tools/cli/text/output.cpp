#include "tools/cli/text/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <ostream>

#include "core/base/message_text.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::string_view kBetween = "  ";

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

std::string_view code_of(Tone tone) {
  switch (tone) {
    case Tone::kPlain: return "";
    case Tone::kFaint: return "\x1b[2m";
    case Tone::kGood: return "\x1b[32m";
    case Tone::kWarning: return "\x1b[33m";
    case Tone::kBad: return "\x1b[31m";
    case Tone::kTitle: return "\x1b[1m";
  }
  return "";
}

}  // namespace

std::size_t display_width(std::string_view utf8) {
  return static_cast<std::size_t>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return !continues(c); }));
}

std::string printable(std::string_view text) {
  return fieldcast::printable(text, std::string::npos);
}

std::string clip(std::string_view utf8, std::size_t columns) {
  std::size_t end = 0;
  for (std::size_t seen = 0; end < utf8.size(); ++end) {
    if (!continues(utf8[end]) && seen++ == columns) break;
  }
  return std::string(utf8.substr(0, end));
}

std::string painted(std::string_view text, Tone tone, bool colour) {
  const auto code = code_of(tone);
  if (!colour || code.empty() || text.empty()) return std::string(text);
  return fmt::format("{}{}\x1b[0m", code, text);
}

void print(std::ostream& out, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) out << line << '\n';
}

void TextTable::add_row(std::vector<Cell> cells) {
  assert(cells.size() <= columns_.size());
  cells.resize(columns_.size());
  for (auto& cell : cells) cell.text = printable(cell.text);
  rows_.push_back(std::move(cells));
}

std::vector<std::string> TextTable::render(const Screen& screen) const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    auto width = display_width(columns_[c].title);
    for (const auto& row : rows_) width = std::max(width, display_width(row[c].text));
    widths.push_back(width);
  }

  const auto line_of = [&](auto&& cell_at) {
    std::string line;
    std::size_t used = 0;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Cell& cell = cell_at(c);
      const auto between = c == 0 ? std::string_view{} : kBetween;
      if (screen.columns != 0 && used + between.size() >= screen.columns) break;
      const auto room = screen.columns == 0
                            ? widths[c]
                            : std::min(widths[c], screen.columns - used - between.size());
      const auto text = clip(cell.text, room);
      const std::string pad(room - display_width(text), ' ');
      line += between;
      if (columns_[c].align == Align::kRight) line += pad;
      line += painted(text, cell.tone, screen.colour);
      if (columns_[c].align == Align::kLeft && c + 1 < columns_.size()) line += pad;
      used += between.size() + room;
    }
    if (!screen.colour) line.erase(line.find_last_not_of(' ') + 1);
    return line;
  };

  std::vector<std::string> lines;
  std::vector<Cell> titles;
  for (const auto& column : columns_) titles.push_back({column.title, Tone::kTitle});
  lines.push_back(line_of([&](std::size_t c) -> const Cell& { return titles[c]; }));
  for (const auto& row : rows_)
    lines.push_back(line_of([&](std::size_t c) -> const Cell& { return row[c]; }));
  return lines;
}

}  // namespace fieldcast::cli
