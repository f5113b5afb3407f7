#include "core/base/json.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <variant>

#include "core/base/message_text.hpp"
#include "core/base/value.hpp"

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

Json::Json(double number) {
  append_json_number(text_, number);
  if (std::isfinite(number) && text_.find_first_of(".e") == text_.npos) text_ += ".0";
}

Json::Json(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && !is_utf8(*text))
    *this = Json(escaped(*text));
  else
    *this = std::visit([](const auto& plain) { return Json(plain); }, value);
}

Json::Json(std::initializer_list<JsonField> fields) : text_("{}") {
  for (const JsonField& field : fields) add(field.name, field.value);
}

void Json::push_back(const Json& item) {
  reopen(']');
  text_ += item.text_;
  text_ += ']';
}

Json& Json::add(std::string_view name, const Json& value) {
  reopen('}');
  append_json_text(text_, name);
  text_ += ':';
  text_ += value.text_;
  text_ += '}';
  return *this;
}

std::string ascii_json(const Json& json) {
  std::string out;
  for (std::string_view rest = json.text(); !rest.empty();) {
    const std::string_view character = rest.substr(0, utf8_length(rest));
    if (character.size() == 1) {
      out += character;
    } else {
      append_json_escape(out, character);
    }
    rest.remove_prefix(character.size());
  }
  return out;
}

void Json::reopen(char bracket) {
  assert(text_.back() == bracket);
  text_.pop_back();
  if (text_.size() > 1) text_ += ',';
}

}  // namespace fieldcast
