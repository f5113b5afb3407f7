#include "core/base/json_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <variant>

#include "core/base/escaped.hpp"
#include "core/base/number_text.hpp"
#include "core/base/printable.hpp"

namespace fieldcast {
namespace {

void append_unit(std::string& out, std::uint16_t unit) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "\\u%04x", unit);
  out += text.data();
}

bool is_plain(char c) {
  return static_cast<unsigned char>(c) >= 0x20 && static_cast<unsigned char>(c) < 0x7F &&
         c != '"' && c != '\\';
}

}  // namespace

void append_json_escape(std::string& out, std::string_view character) {
  switch (character.front()) {
    case '\n': out += "\\n"; return;
    case '\r': out += "\\r"; return;
    case '\t': out += "\\t"; return;
    default: break;
  }
  const char32_t code = code_point(character);
  if (code <= 0xFFFF) return append_unit(out, static_cast<std::uint16_t>(code));
  append_unit(out, static_cast<std::uint16_t>(0xD800u | (code - 0x10000u) >> 10));
  append_unit(out, static_cast<std::uint16_t>(0xDC00u | ((code - 0x10000u) & 0x3FFu)));
}

void append_json_text(std::string& out, std::string_view text) {
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
        append_json_escape(out, character);
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

void append_json_number(std::string& out, double number) {
  out += std::isfinite(number) ? number_text(number) : "null";
}

void append_json_value(std::string& out, const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    append_json_text(out, is_utf8(*text) ? *text : escaped(*text));
  } else if (const auto* real = std::get_if<double>(&value)) {
    append_json_number(out, *real);
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

std::string json_joined(std::string object, std::string_view more) {
  if (more == "{}") return object;
  object.back() = ',';
  return object.append(more, 1);
}

std::string& JsonObject::begin(std::string_view name) {
  if (text_.size() > 1) text_ += ',';
  append_json_text(text_, name);
  return text_ += ':';
}

}  // namespace fieldcast
