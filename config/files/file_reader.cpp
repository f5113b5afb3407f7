#include "config/files/file_reader.hpp"

#include <algorithm>

#include "config/document/map_reader.hpp"

namespace fieldcast::config {

namespace {

constexpr auto kNone = std::string_view::npos;
constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kPrivate = "-----BEGIN";  // of a key or a certificate in PEM form

std::string_view without_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

std::string_view next_line(std::string_view& rest) {
  const auto end = rest.find('\n');
  const std::string_view line = rest.substr(0, end);
  rest = end == kNone ? std::string_view{} : rest.substr(end + 1);
  return line;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == kNone) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

bool has_content(std::string_view line) {
  const std::string_view content = trimmed(line);
  return !content.empty() && !content.starts_with('#') && content != "---";
}

// "KEY:" followed by a blank or the end; the key may be quoted.
bool begins_with_key(std::string_view text, std::string_view key) {
  const bool quoted = text.starts_with('"') || text.starts_with('\'');
  const char quote = quoted ? text.front() : '\0';
  if (quoted) text.remove_prefix(1);
  if (!text.starts_with(key)) return false;
  text.remove_prefix(key.size());
  if (quoted) {
    if (!text.starts_with(quote)) return false;
    text.remove_prefix(1);
  }
  while (text.starts_with(' ')) text.remove_prefix(1);
  if (!text.starts_with(':')) return false;
  return quoted || text.size() == 1 || text[1] == ' ' || text[1] == '\t' || text[1] == '\r' ||
         text[1] == '\n';
}

// In a map in braces, matches the key at any depth.
bool in_braces(std::string_view text, std::string_view key) {
  for (auto at = text.find_first_of("{,\n"); at != kNone; at = text.find_first_of("{,\n", at + 1)) {
    const auto begin = text.find_first_not_of(" \t", at + 1);
    if (begin != kNone && begins_with_key(text.substr(begin), key)) return true;
  }
  return false;
}

}  // namespace

bool is_empty(std::string_view text) {
  text = without_mark(text);
  while (!text.empty()) {
    if (has_content(next_line(text))) return false;
  }
  return true;
}

bool has_top_key(std::string_view text, std::initializer_list<std::string_view> keys) {
  text = without_mark(text);
  if (text.find(kPrivate) != kNone) return false;
  const auto any = [&](auto found) { return std::ranges::any_of(keys, found); };
  std::size_t indent = kNone;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = next_line(rest);
    if (!has_content(line)) continue;
    const auto begin = line.find_first_not_of(' ');
    if (indent == kNone) {
      indent = begin;
      const std::string_view first = trimmed(line);
      if (first.starts_with('{') || first.starts_with("--- {"))
        return any([&](std::string_view key) { return in_braces(text, key); });
    }
    if (begin == indent &&
        any([&](std::string_view key) { return begins_with_key(line.substr(begin), key); }))
      return true;
  }
  return false;
}

bool has_columns(std::string_view text) {
  text = without_mark(text);
  if (text.find(kPrivate) != kNone) return false;
  while (!text.empty()) {
    std::string_view line = next_line(text);
    if (!has_content(line)) continue;
    while (!line.empty()) {
      const auto end = std::min(line.find_first_of(",;\t"), line.size());
      std::string_view cell = trimmed(line.substr(0, end));
      line.remove_prefix(std::min(end + 1, line.size()));
      if (cell.starts_with('"')) cell = cell.substr(1, cell.size() > 1 ? cell.size() - 2 : 0);
      if (cell == "name" || cell == "at") return true;
    }
    return false;
  }
  return false;
}

bool is_configuration(std::string_view text) { return has_top_key(text, {"bridge", "buses"}); }
bool is_template(std::string_view text) { return has_top_key(text, {"channels", "protocols"}); }
bool is_declaration(std::string_view text) {
  return has_top_key(text, {"summary", "areas", "operations"});
}

}  // namespace fieldcast::config
