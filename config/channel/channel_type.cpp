#include <fmt/format.h>

#include "config/channel/channel.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {
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
