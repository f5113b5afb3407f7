// Writes JSON text piece by piece, without a tree in memory. Pure.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// 2^53: up to here a double (IEEE 754) and so a browser represents every integer exactly.
inline constexpr std::uint64_t kMaxExact = std::uint64_t{1} << 53;

// With its quotes. Bytes that are not UTF-8 become U+FFFD; a character that is not
// is_printable() (core/base/message_text.hpp) is written as \u202e.
void append_json_text(std::string& out, std::string_view text);
// The character as \n, \u202e or, above U+FFFF, two of these (RFC 8259, 7). REQUIRES: one character
// of valid UTF-8.
void append_json_escape(std::string& out, std::string_view character);
// The fewest digits that read back as the same number; null for NaN and infinities.
void append_json_number(std::string& out, double number);
// For browsers: integers beyond kMaxExact are texts. Bytes that are not UTF-8 are written as \xE4.
void append_json_value(std::string& out, const Value& value);
// Unix time in milliseconds, with a fraction; 0 for no such time.
[[nodiscard]] double unix_ms(UtcTime time);
[[nodiscard]] double milliseconds(Duration duration);

// Escapes names too, because some, such as causes, are received from the network.
class JsonObject {
 public:
  JsonObject& add(std::string_view name, std::string_view text) {
    append_json_text(begin(name), text);
    return *this;
  }
  JsonObject& add(std::string_view name, const char* text) {
    return add(name, std::string_view(text));
  }
  JsonObject& add(std::string_view name, double number) {
    append_json_number(begin(name), number);
    return *this;
  }
  JsonObject& add(std::string_view name, std::integral auto number) {
    if constexpr (std::same_as<decltype(number), bool>) {
      begin(name) += number ? "true" : "false";
    } else {
      begin(name) += std::to_string(number);
    }
    return *this;
  }
  // Null for an unset time.
  JsonObject& add(std::string_view name, UtcTime time) {
    if (time.nanoseconds == 0) return add_json(name, "null");
    return add(name, unix_ms(time));
  }
  JsonObject& add_value(std::string_view name, const Value& value) {
    append_json_value(begin(name), value);
    return *this;
  }
  // `json` is encoded already.
  JsonObject& add_json(std::string_view name, std::string_view json) {
    begin(name) += json;
    return *this;
  }
  [[nodiscard]] std::string take() {
    text_ += '}';
    return std::move(text_);
  }

 private:
  std::string& begin(std::string_view name);

  std::string text_ = "{";
};

[[nodiscard]] std::string json_joined(std::string object, std::string_view more);

// "[1,2]" of anything that `append(out, item)` appends.
template <class Items, class Append>
[[nodiscard]] std::string json_array(const Items& items, Append append) {
  std::string text = "[";
  for (const auto& item : items) {
    if (text.size() > 1) text += ',';
    append(text, item);
  }
  return text + ']';
}

// A JSON text as a value: objects, arrays and plain values for JSON lines and reports. Pure.
struct JsonField;

class Json {
 public:
  Json(std::nullptr_t = nullptr) : text_("null") {}
  Json(bool flag) : text_(flag ? "true" : "false") {}
  Json(std::integral auto number) : text_(std::to_string(number)) {}
  // As append_json_number(), with ".0" if whole, so that typed readers read a real number.
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
