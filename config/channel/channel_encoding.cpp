#include "config/channel/channel_encoding.hpp"

#include <fmt/format.h>

#include "config/channel/channel.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {

namespace {

constexpr unsigned kRegisterBits = 16;

bool has_exponent_type(const Encoding& encoding) {
  switch (encoding.type) {
    case ValueType::kBool:
    case ValueType::kString:
    case ValueType::kFloat32:
    case ValueType::kFloat64: return false;
    default: return !encoding.text_number;
  }
}

}  // namespace

void read_exponent(MapReader& map, const Protocol* protocol, const ParsedAddress* value,
                   ChannelSpec& spec) {
  std::string at;
  if (!map.read(kExponentKey, at, TextRule{kMaxNameLength}) || value == nullptr) return;
  const auto fault = [&](const std::string& what, const std::string& allowed) {
    map.fault(kExponentKey, what, allowed);
  };
  const Area& area = protocol->areas()[value->area];
  if (!has_exponent_type(spec.encoding)) {
    const bool text = static_cast<bool>(spec.encoding.text_number);
    return fault(
        fmt::format("'{}' at a {}", kExponentKey, text ? "number as text" : to_text(spec.encoding)),
        "a channel of an integer or BCD type");
  }
  if (area.item_bits != kRegisterBits || value->value_bits != 0) {
    return fault(
        fmt::format("'{}' at '{}', which is not in 16-bit registers", kExponentKey, spec.at),
        "a channel in an area of 16-bit registers");
  }
  const auto exponent = protocol->parse_address(at);
  if (!exponent) {
    map.fault(kExponentKey, exponent.error().what, exponent.error().allowed,
              exponent.error().suggestion);
    return;
  }
  if (exponent->area != value->area || exponent->bit) {
    return fault(
        fmt::format("'{}' is not a register of area {}, in which '{}' is", at, area.name, spec.at),
        fmt::format("a whole register of area {}", area.name));
  }
  const std::int64_t distance = std::int64_t{exponent->first} - value->first;
  const std::uint32_t own = item_count(spec.encoding, kRegisterBits);
  if (distance >= 0 && distance < own) {
    return fault(fmt::format("'{}' is part of the value at '{}'", at, spec.at),
                 "a register before or behind the value");
  }
  spec.exponent_from = std::move(at);
  spec.encoding.exponent_distance = static_cast<std::int32_t>(distance);
}

namespace {

constexpr std::string_view kKey = "not-available";

std::string values_allowed(const Encoding& encoding) {
  const Encoding plain{.type = encoding.type};
  const std::string bits = fmt::format("0x0 to 0x{:X} (the bits of {})",
                                       UINT64_MAX >> (64 - width_bits(plain)), to_text(plain));
  const bool real = encoding.type == ValueType::kFloat32 || encoding.type == ValueType::kFloat64;
  return bits + (real ? ", a number, or nan" : ", or a raw number of the type");
}

// A cell of a channel list may contain several, separated by spaces.
void add_values(const Node& node, Encoding& encoding, FaultList& faults) {
  const std::string allowed = values_allowed(encoding);
  const std::string* text = scalar_of(node, kKey, allowed, faults);
  if (text == nullptr) return;
  std::string_view rest = *text;
  do {
    const auto end = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.find_first_not_of(' ', end), rest.size()));
    const auto bits = parse_not_available(encoding, word);
    if (!bits) {
      faults.add(node.position,
                 fmt::format("{} '{}' is not a raw value of type {}", kKey, word,
                             to_text(Encoding{.type = encoding.type})),
                 allowed);
      return;
    }
    encoding.not_available.push_back(*bits);
  } while (!rest.empty());
}

}  // namespace

void read_not_available(MapReader& map, bool typed, Encoding& encoding) {
  const Node* node = map.find(kKey);
  if (node == nullptr || !typed) return;
  if (encoding.type == ValueType::kBool || encoding.type == ValueType::kString) {
    map.faults().add(node->position, fmt::format("'{}' at a {}", kKey, to_text(encoding.type)),
                     "a channel of a numeric type");
    return;
  }
  if (node->kind == Kind::kList) {
    for (const Node* item : node->items) add_values(*item, encoding, map.faults());
  } else {
    add_values(*node, encoding, map.faults());
  }
  if (encoding.not_available.size() > kMaxNotAvailable ||
      (node->kind == Kind::kList && node->items.empty())) {
    map.faults().add(node->position,
                     fmt::format("{} has {} values", kKey, encoding.not_available.size()),
                     fmt::format("1 to {} values", kMaxNotAvailable));
  }
}

std::string not_available_schema() {
  const std::string value = R"({ "type": ["string", "number"] })";
  return fmt::format(R"({{ "anyOf": [ {0}, )"
                     R"({{ "type": "array", "minItems": 1, "maxItems": {1}, "items": {0} }} ] }})",
                     value, kMaxNotAvailable);
}

namespace {

// Names in other programs.
constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
    {"boolean", "bool"},     {"bit", "bool"},      {"byte", "uint8"},   {"usint", "uint8"},
    {"sint", "int8"},        {"char", "uint8"},    {"int", "int16"},    {"integer", "int16"},
    {"short", "int16"},      {"word", "uint16"},   {"uint", "uint16"},  {"dint", "int32"},
    {"long", "int32"},       {"dword", "uint32"},  {"udint", "uint32"}, {"lint", "int64"},
    {"ulint", "uint64"},     {"float", "float32"}, {"real", "float32"}, {"single", "float32"},
    {"f32", "float32"},      {"f64", "float64"},   {"i8", "int8"},      {"u8", "uint8"},
    {"i16", "int16"},        {"s16", "int16"},     {"u16", "uint16"},   {"i32", "int32"},
    {"s32", "int32"},        {"u32", "uint32"},    {"i64", "int64"},    {"u64", "uint64"},
    {"double", "float64"},   {"lreal", "float64"}, {"bcd", "bcd16"},    {"text", "string(20)"},
    {"string", "string(20)"}};

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

std::optional<Encoding> TypeRule::operator()(const Node& node, std::string_view key,
                                             FaultList& faults) const {
  std::vector<std::string_view> words;
  for (const auto type : plain_types()) words.push_back(fieldcast::to_text(type));
  const std::string allowed = allowed_types();
  const std::string* text = scalar_of(node, key, allowed, faults);
  if (text == nullptr) return std::nullopt;

  Encoding encoding;
  for (const auto type : plain_types()) {
    if (*text != fieldcast::to_text(type)) continue;
    encoding.type = type;
    return encoding;
  }
  const std::string_view written = *text;
  if (written.starts_with("string(") && written.ends_with(')')) {
    const auto bytes = whole_from(written.substr(7, written.size() - 8));
    if (bytes && *bytes >= 1 && *bytes <= kMaxStringBytes) {
      encoding.type = ValueType::kString;
      encoding.string_bytes = static_cast<std::uint16_t>(*bytes);
      return encoding;
    }
  }
  std::string meant = closest(written, words);
  for (const auto& [other, ours] : kOtherNames) {
    if (lower(*text) == other) meant = ours;
  }
  faults.add(node.position, fmt::format("type '{}' is unknown", *text), allowed, meant);
  return std::nullopt;
}

std::string TypeRule::schema() const {
  std::string words;
  for (const auto type : plain_types())
    words += (words.empty() ? "" : "|") + std::string(fieldcast::to_text(type));
  return R"({ "type": "string", "pattern": "^()" + words + R"(|string\\([0-9]{1,3}\\))$" })";
}
std::string TypeRule::form() const { return {}; }

}  // namespace fieldcast::config
