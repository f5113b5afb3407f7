// The type of a channel as written (channel.hpp).
#include <array>

#include "config/channel.hpp"
#include "config/scalars.hpp"

namespace fieldcast::config {
namespace {

constexpr std::int64_t kMaxStringBytes = 250;  // what one Modbus read carries: 125 registers

constexpr std::array<ValueType, 11> kPlainTypes{ValueType::kBool,    ValueType::kInt16, ValueType::kUint16, ValueType::kInt32,
                                                ValueType::kUint32,  ValueType::kInt64, ValueType::kUint64, ValueType::kFloat32,
                                                ValueType::kFloat64, ValueType::kBcd16, ValueType::kBcd32};

// What other programs call them.
constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
    {"boolean", "bool"},     {"bit", "bool"},       {"int", "int16"},     {"integer", "int16"}, {"short", "int16"},
    {"word", "uint16"},      {"uint", "uint16"},    {"dint", "int32"},    {"long", "int32"},    {"dword", "uint32"},
    {"udint", "uint32"},     {"lint", "int64"},     {"ulint", "uint64"},  {"float", "float32"}, {"real", "float32"},
    {"single", "float32"},   {"double", "float64"}, {"lreal", "float64"}, {"bcd", "bcd16"},     {"text", "string(20)"},
    {"string", "string(20)"}};

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

std::optional<Encoding> TypeRule::operator()(const Node& node, std::string_view key, FaultList& faults) const {
  std::vector<std::string_view> words;
  for (const auto type : kPlainTypes) words.push_back(fieldcast::to_text(type));
  const std::string allowed = joined(words) + ", string(1) to string(" + std::to_string(kMaxStringBytes) + ')';
  const std::string* text = scalar_of(node, key, allowed, faults);
  if (text == nullptr) return std::nullopt;

  Encoding encoding;
  for (const auto type : kPlainTypes) {
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
  faults.add(node.place, "type '" + *text + "' is unknown", allowed, meant);
  return std::nullopt;
}

}  // namespace fieldcast::config
