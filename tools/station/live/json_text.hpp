// Writes JSON text piece by piece, without a tree in memory. Pure.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast::web {

// 2^53: up to here a double (IEEE 754) and so a browser represents every integer exactly.
inline constexpr std::uint64_t kMaxExact = std::uint64_t{1} << 53;

// Appends a quoted string. Invalid UTF-8 becomes U+FFFD; other characters than is_printable()
// (core/base/printable.hpp) are escaped, for example \u202e.
void append_text(std::string& out, std::string_view text);
// Appends the fewest digits that read back as the same number; null for NaN and infinities.
void append_number(std::string& out, double number);
// Integers beyond kMaxExact become strings; invalid UTF-8 becomes an escape such as \xE4.
void append_value(std::string& out, const Value& value);
// Unix time in milliseconds with a fraction; 0 for an unset time.
[[nodiscard]] double unix_ms(UtcTime time);
[[nodiscard]] double milliseconds(Duration duration);

// Escapes names too, because some, such as causes, are received from the network.
class JsonObject {
 public:
  JsonObject& add(std::string_view name, std::string_view text) {
    append_text(begin(name), text);
    return *this;
  }
  JsonObject& add(std::string_view name, const char* text) {
    return add(name, std::string_view(text));
  }
  JsonObject& add(std::string_view name, double number) {
    append_number(begin(name), number);
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
    append_value(begin(name), value);
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

// Returns "[1,2]"; `append(out, item)` encodes an item.
template <class Items, class Append>
[[nodiscard]] std::string json_array(const Items& items, Append append) {
  std::string text = "[";
  for (const auto& item : items) {
    if (text.size() > 1) text += ',';
    append(text, item);
  }
  return text + ']';
}

}  // namespace fieldcast::web
