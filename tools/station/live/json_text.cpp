#include "tools/station/live/json_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <variant>

#include "core/base/escaped.hpp"
#include "core/base/number_text.hpp"
#include "core/base/printable.hpp"

namespace fieldcast::web {
namespace {

// REQUIRES: a character up to U+FFFF.
void append_code(std::string& out, std::string_view character) {
  switch (character.front()) {
    case '\n': out += "\\n"; return;
    case '\r': out += "\\r"; return;
    case '\t': out += "\\t"; return;
    default: break;
  }
  unsigned code = static_cast<unsigned char>(character.front());
  if (character.size() == 2) code &= 0x1Fu;
  if (character.size() == 3) code &= 0x0Fu;
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned>(c) & 0x3Fu);
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "\\u%04x", code);
  out += text.data();
}

bool is_plain(char c) {
  return static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7F &&
         c != '"' && c != '\\';
}

}  // namespace

void append_text(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    const auto special = std::find_if_not(text.begin(), text.end(), is_plain);
    const auto plain = static_cast<std::size_t>(special - text.begin());
    out += text.substr(0, plain);
    text.remove_prefix(plain);
    if (text.empty()) break;
    const char c = text.front();
    std::size_t taken = 1;
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (const std::size_t length = utf8_length(text); length != 0) {
      const std::string_view character = text.substr(0, length);
      if (!is_printable(character)) {
        append_code(out, character);
      } else {
        out += character;
      }
      taken = length;
    } else {
      out += "\xEF\xBF\xBD";
    }
    text.remove_prefix(taken);
  }
  out += '"';
}

void append_number(std::string& out, double number) {
  out += std::isfinite(number) ? number_text(number) : "null";
}

void append_value(std::string& out, const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    append_text(out, is_utf8(*text) ? *text : escaped(*text));
  } else if (const auto* real = std::get_if<double>(&value)) {
    append_number(out, *real);
  } else if (const auto* whole = std::get_if<std::uint64_t>(&value)) {
    const bool exact = *whole <= kMaxExact;
    out += exact ? std::to_string(*whole) : '"' + std::to_string(*whole) + '"';
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    const auto most = static_cast<std::int64_t>(kMaxExact);
    const bool exact = *integer <= most && *integer >= -most;
    out += exact ? std::to_string(*integer) : '"' + std::to_string(*integer) + '"';
  } else {
    out += std::get<bool>(value) ? "true" : "false";
  }
}

double unix_ms(UtcTime time) { return static_cast<double>(time.nanoseconds) / 1e6; }

double milliseconds(Duration duration) { return static_cast<double>(duration.count()) / 1e6; }

std::string& JsonObject::begin(std::string_view name) {
  if (text_.size() > 1) text_ += ',';
  append_text(text_, name);
  return text_ += ':';
}

}  // namespace fieldcast::web
