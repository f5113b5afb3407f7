#include "tools/import/points/channel_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/base/value.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/points/writer.hpp"

namespace fieldcast::importing {
namespace {

// `map`: "limits" or "write" for nested keys.
struct KeyValue {
  std::string_view map, key, column;
  std::string value;
};

// Word order matters for numbers of several registers, byte order also for text.
bool has_words(const Point& point) {
  return is_number(point.type) && registers_of(point.type, 0) > 1;
}
bool has_bytes(const Point& point) { return point.type != ValueType::kBool && !point.byte; }

class Keys {
 public:
  void add(std::string_view key, std::string value) { add({}, key, key, std::move(value)); }
  void add(std::string_view map, std::string_view key, std::string_view column, std::string value) {
    values_.push_back({map, key, column, std::move(value)});
  }
  void add(std::string_view map, std::string_view key, std::string_view column,
           const std::optional<double>& number) {
    if (number) add(map, key, column, number_text(*number));
  }
  [[nodiscard]] std::vector<KeyValue> take() { return std::move(values_); }

 private:
  std::vector<KeyValue> values_;
};

void add_orders(Keys& keys, const Point& point, const SharedKeys& shared) {
  const auto word = [](bool little) { return little ? "little-endian" : "big-endian"; };
  if (has_words(point) && point.word_order != shared.word_order)
    keys.add("word-order", word(point.word_order == WordOrder::kLittleEndian));
  if (has_bytes(point) && point.byte_order != shared.byte_order)
    keys.add("byte-order", word(point.byte_order == ByteOrder::kLittleEndian));
}

std::vector<KeyValue> keys_of(const Point& point, const SharedKeys& shared) {
  Keys keys;
  keys.add("name", point.name);
  keys.add("at", point.at);
  keys.add("type", type_text(point));
  if (point.byte) keys.add("byte", *point.byte == 0 ? "low" : "high");
  add_orders(keys, point, shared);
  if (point.scale != 1) keys.add("scale", number_text(point.scale));
  if (point.offset != 0) keys.add("offset", number_text(point.offset));
  if (!point.unit.empty()) keys.add("unit", point.unit);
  if (point.refresh && point.refresh != shared.refresh)
    keys.add("refresh", to_text(*point.refresh));
  if (point.on_demand) keys.add("mode", "on-demand");
  if (point.access != Access::kReadOnly) keys.add("access", std::string(to_text(point.access)));
  keys.add("", "deadband", "deadband", point.deadband);
  keys.add("limits", "low-low", "low-low", point.low_low);
  keys.add("limits", "low", "low", point.low);
  keys.add("limits", "high", "high", point.high);
  keys.add("limits", "high-high", "high-high", point.high_high);
  keys.add("limits", "hysteresis", "hysteresis", point.hysteresis);
  keys.add("write", "min", "write-min", point.write_min);
  keys.add("write", "max", "write-max", point.write_max);
  if (!point.description.empty()) keys.add("description", point.description);
  return keys.take();
}

constexpr std::array<std::string_view, 21> kColumnOrder{
    "name",   "at",   "type",      "byte",       "word-order", "byte-order", "scale",
    "offset", "unit", "refresh",   "mode",       "access",     "deadband",   "low-low",
    "low",    "high", "high-high", "hysteresis", "write-min",  "write-max",  "description"};

std::string csv_cell(std::string_view text) {
  const bool plain = text.find_first_of("\",;\t\n\r") == std::string_view::npos &&
                     !text.starts_with(' ') && !text.ends_with(' ') && !text.starts_with('#');
  if (plain) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c == '\n' || c == '\r' ? ' ' : c;
  }
  return cell + '"';
}

bool is_word(std::string_view text) {
  constexpr std::array<std::string_view, 9> kMeanMore{"true", "false", "yes", "no", "on",
                                                      "off",  "null",  "y",   "n"};
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (text.empty() || !letter(text[0])) return false;
  std::string lower_case(text);
  std::ranges::transform(lower_case, lower_case.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
  if (std::ranges::find(kMeanMore, lower_case) != kMeanMore.end()) return false;
  return std::ranges::all_of(text, [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.' || c == '(' ||
           c == ')' || c == '/';
  });
}

}  // namespace

std::string type_text(const Point& point) {
  if (point.type == ValueType::kString) return fmt::format("string({})", point.string_bytes);
  return std::string(to_text(point.type));
}

std::string yaml_text(std::string_view text) {
  if (is_word(text)) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20) {
      quoted += fmt::format("\\x{:02X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

SharedKeys shared_keys(const Device& device) {
  SharedKeys shared;
  const auto& points = device.points;
  const auto same = [&](auto member, auto concerns) {
    const auto first = std::ranges::find_if(points, concerns);
    return first != points.end() && std::ranges::all_of(points, [&](const Point& point) {
             return !concerns(point) || point.*member == (*first).*member;
           });
  };
  const auto all = [](const Point&) { return true; };
  if (same(&Point::refresh, all)) shared.refresh = points.front().refresh;
  if (same(&Point::word_order, has_words))
    shared.word_order = std::ranges::find_if(points, has_words)->word_order;
  if (same(&Point::byte_order, has_bytes))
    shared.byte_order = std::ranges::find_if(points, has_bytes)->byte_order;
  return shared;
}

std::string yaml_channel(const Point& point, const SharedKeys& shared) {
  std::string text = "{ ";
  std::string_view map;
  bool first = true;
  for (const KeyValue& key : keys_of(point, shared)) {
    if (key.map != map && !map.empty()) text += " }";
    if (!std::exchange(first, false)) text += ", ";
    if (key.map != map && !key.map.empty()) text += fmt::format("{}: {{ ", key.map);
    map = key.map;
    const bool is_text =
        key.key == "at" || key.key == "unit" || key.key == "description" || key.key == "name";
    text += fmt::format("{}: {}", key.key, is_text ? yaml_text(key.value) : key.value);
  }
  return text + (map.empty() ? " }" : " } }");
}

std::vector<std::string> csv_columns(const Device& device, const SharedKeys& shared) {
  std::vector<std::string> used;
  for (const Point& point : device.points) {
    for (const KeyValue& key : keys_of(point, shared)) {
      if (std::ranges::find(used, key.column) == used.end()) used.emplace_back(key.column);
    }
  }
  std::ranges::sort(used, {}, [](const std::string& column) {
    return std::ranges::find(kColumnOrder, column) - kColumnOrder.begin();
  });
  return used;
}

std::string csv_row(const Point& point, const SharedKeys& shared,
                    const std::vector<std::string>& columns) {
  const auto keys = keys_of(point, shared);
  std::string row;
  for (const std::string& column : columns) {
    if (&column != &columns.front()) row += ',';
    const auto key = std::ranges::find(keys, column, &KeyValue::column);
    if (key != keys.end()) row += csv_cell(key->value);
  }
  return row;
}

}  // namespace fieldcast::importing
