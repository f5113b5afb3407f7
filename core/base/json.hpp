// A JSON text as a value: objects, arrays and plain values for JSON lines and reports. Pure.
// core/base/json_text.hpp appends to a string instead, for long lists.
#pragma once

#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>

#include "core/base/json_text.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

struct JsonField;

class Json {
 public:
  Json(std::nullptr_t = nullptr) : text_("null") {}
  Json(bool flag) : text_(flag ? "true" : "false") {}
  Json(std::integral auto number) : text_(std::to_string(number)) {}
  // The fewest digits that read back as the same number, with ".0" if it is whole, so that readers
  // with integer types read a real number; null for NaN and infinities.
  Json(double number);
  Json(std::string_view text) { append_json_text(text_, text); }
  Json(const std::string& text) : Json(std::string_view(text)) {}
  Json(const char* text) : Json(std::string_view(text)) {}
  // Integers are exact to 64 bits; bytes of a text that are not UTF-8 are written as \xE4.
  Json(const Value& value);
  template <class T>
  Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}
  // An object; fields stay in the order in which they were written.
  Json(std::initializer_list<JsonField> fields);
  // An array, or an object if the items are pairs of a name and a value.
  template <std::ranges::input_range Items>
  requires(!std::convertible_to<Items, std::string_view>) Json(const Items& items);

  [[nodiscard]] static Json array() { return {Brackets{}, "[]"}; }
  [[nodiscard]] static Json object() { return {Brackets{}, "{}"}; }

  // REQUIRES: an array.
  void push_back(const Json& item);
  // REQUIRES: an object without a field of this name.
  Json& add(std::string_view name, const Json& value);

  // One line.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  struct Brackets {};
  Json(Brackets, const char* text) : text_(text) {}
  // Opens the text again for one more item, before the bracket that closes it.
  void reopen(char bracket);

  std::string text_;
};

struct JsonField {
  std::string_view name;
  Json value;
};

template <std::ranges::input_range Items>
requires(!std::convertible_to<Items, std::string_view>) Json::Json(const Items& items) {
  constexpr bool named = requires(std::ranges::range_value_t<Items> item) {
    { item.first } -> std::convertible_to<std::string_view>;
  };
  text_ = named ? "{}" : "[]";
  for (const auto& item : items) {
    if constexpr (named) {
      add(item.first, item.second);
    } else {
      push_back(item);
    }
  }
}

// With every character outside ASCII as \u00e4, for databases with another character set.
[[nodiscard]] std::string ascii_json(const Json& json);

}  // namespace fieldcast
