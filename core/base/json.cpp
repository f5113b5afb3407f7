#include "core/base/json.hpp"

#include <cassert>
#include <cmath>
#include <variant>

#include "core/base/escaped.hpp"

namespace fieldcast {

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
