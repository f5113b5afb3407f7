#include "config/document/scalars.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "core/base/duration_text.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast::config {
namespace {

std::string in_quotes(std::string_view key, std::string_view text) {
  return fmt::format("{} '{}'", key, text);
}

bool digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

const std::string* scalar_of(const Node& node, std::string_view key, std::string_view wanted,
                             FaultList& faults) {
  if (node.kind == Kind::kScalar) return &node.text;
  faults.add(node.position, fmt::format("{} is {}", key, to_text(node.kind)), wanted);
  return nullptr;
}

bool is_list(const Node& node, std::string_view key, std::size_t least, std::size_t most,
             std::string_view allowed, FaultList& faults, std::string_view suggestion) {
  const bool list = node.kind == Kind::kList;
  if (list && node.items.size() >= least && node.items.size() <= most) return true;
  const std::string_view wrong = !list                ? to_text(node.kind)
                                 : node.items.empty() ? "empty"
                                                      : "too long";
  faults.add(node.position, fmt::format("{} is {}", key, wrong), allowed, suggestion);
  return false;
}

std::string as_list(const Node& node) {
  return node.kind == Kind::kScalar ? fmt::format("[{}]", node.text) : std::string{};
}

std::optional<double> number_from(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_from(std::string_view text) {
  const bool hexadecimal = text.starts_with("0x");
  if (hexadecimal) text.remove_prefix(2);
  if (hexadecimal && text.starts_with('-')) return std::nullopt;
  std::int64_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_ipv4(std::string_view text) {
  unsigned parts = 0;
  while (true) {
    const auto point = std::min(text.find('.'), text.size());
    const auto part = text.substr(0, point);
    const auto value = whole_from(part);
    if (part.empty() || part.size() > 3 || part.find_first_not_of("0123456789") != part.npos ||
        !value || *value > 255)
      return false;
    ++parts;
    if (point == text.size()) return parts == 4;
    text.remove_prefix(point + 1);
  }
}

std::optional<Duration> DurationRule::operator()(const Node& node, std::string_view key,
                                                 FaultList& faults) const {
  const std::string* text = scalar_of(node, key, kDurationForm, faults);
  if (text == nullptr) return std::nullopt;
  const auto value = read_duration(*text, {min, max});
  if (value) return *value;
  auto fault = value.error();
  faults.add(node.position, in_quotes(key, *text) + ' ' + fault.what, fault.allowed.append(or_else),
             std::move(fault.suggestion));
  return std::nullopt;
}

std::optional<std::int64_t> WholeRule::operator()(const Node& node, std::string_view key,
                                                  FaultList& faults) const {
  const std::string bounds = fmt::format("{} to {}", min, max);
  const std::string* text = scalar_of(node, key, "a whole number, " + bounds, faults);
  if (text == nullptr) return std::nullopt;
  const auto value = whole_from(*text);
  if (!value || node.quoted) {
    faults.add(
        node.position,
        in_quotes(key, *text) + (value ? " is quoted, so it is a text" : " is no whole number"),
        "a whole number, " + bounds, value ? *text : "");
    return std::nullopt;
  }
  if (*value < min || *value > max) {
    faults.add(node.position, in_quotes(key, *text) + " is out of range", bounds);
    return std::nullopt;
  }
  return value;
}

std::optional<double> NumberRule::operator()(const Node& node, std::string_view key,
                                             FaultList& faults) const {
  const std::string* text = scalar_of(node, key, "a number", faults);
  if (text == nullptr) return std::nullopt;
  const auto value = number_from(*text);
  if (value && !node.quoted && (*value < min || *value > max)) {
    faults.add(
        node.position, in_quotes(key, *text) + " is out of range",
        fmt::format("{} to {}", fieldcast::to_text(Value{min}), fieldcast::to_text(Value{max})));
    return std::nullopt;
  }
  if (value && !node.quoted) return value;
  std::string with_point = *text;
  if (const auto comma = with_point.find(','); comma != std::string::npos) with_point[comma] = '.';
  faults.add(node.position,
             in_quotes(key, *text) + (value ? " is quoted, so it is a text" : " is no number"),
             "a number such as 0.1", number_from(with_point) ? with_point : "");
  return std::nullopt;
}

std::optional<bool> FlagRule::operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const {
  const std::string* text = scalar_of(node, key, "true, false", faults);
  if (text == nullptr) return std::nullopt;
  if (!node.quoted && (*text == "true" || *text == "false")) return *text == "true";
  static constexpr std::array<std::string_view, 9> kTrue{"true", "True", "TRUE", "yes", "Yes",
                                                         "on",   "On",   "y",    "1"};
  static constexpr std::array<std::string_view, 9> kFalse{"false", "False", "FALSE", "no", "No",
                                                          "off",   "Off",   "n",     "0"};
  std::string meant = closest(*text, std::array<std::string_view, 2>{"true", "false"});
  for (const auto word : kTrue) meant = *text == word ? "true" : meant;
  for (const auto word : kFalse) meant = *text == word ? "false" : meant;
  faults.add(node.position, in_quotes(key, *text) + " is neither true nor false", "true, false",
             meant);
  return std::nullopt;
}

std::optional<std::string> TextRule::operator()(const Node& node, std::string_view key,
                                                FaultList& faults) const {
  const std::string* text = scalar_of(node, key, "a text", faults);
  if (text == nullptr) return std::nullopt;
  std::string_view line = *text;
  while (line.ends_with('\n')) line.remove_suffix(1);  // as at the end of block texts
  if (line.empty() || line.size() > max_bytes) {
    faults.add(node.position, std::string(key) + (line.empty() ? " is empty" : " is too long"),
               fmt::format("1 to {} bytes", max_bytes));
    return std::nullopt;
  }
  for (const char c : line) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) continue;
    faults.add(node.position,
               fmt::format("{} holds a line break or another control character", key),
               "one line of text");
    return std::nullopt;
  }
  return std::string(line);
}

std::optional<std::string> NameRule::operator()(const Node& node, std::string_view key,
                                                FaultList& faults) const {
  static constexpr std::string_view kForm = "1 to 64 letters, digits, '-', '_', '.'";
  const std::string* text = scalar_of(node, key, kForm, faults);
  if (text == nullptr) return std::nullopt;
  std::string fitting;
  bool replaced = false;
  for (const char c : *text) {
    const bool allowed = digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' ||
                         c == '_' || c == '.';
    if (allowed)
      fitting += c;
    else if (!std::exchange(replaced, true) || !fitting.ends_with('-'))
      fitting += '-';
  }
  if (!replaced && !text->empty() && text->size() <= kMaxNameLength) return *text;
  const bool empty = fitting.empty() || fitting == "-";
  faults.add(node.position,
             in_quotes(key, *text) + (replaced        ? " holds other characters"
                                      : text->empty() ? " is empty"
                                                      : " is too long"),
             kForm, empty ? "" : fitting.substr(0, kMaxNameLength));
  return std::nullopt;
}

std::string DurationRule::schema() const { return R"({ "$ref": "#/$defs/duration" })"; }
std::string DurationRule::form() const {
  if (min == Duration{}) return "up to " + fieldcast::to_text(max);
  return fmt::format("{} to {}", fieldcast::to_text(min), fieldcast::to_text(max));
}

std::string WholeRule::schema() const {
  return R"({ "type": "integer", "minimum": )" + std::to_string(min) + R"(, "maximum": )" +
         std::to_string(max) + " }";
}
std::string WholeRule::form() const { return fmt::format("{} to {}", min, max); }

std::optional<std::int64_t> SizeRule::operator()(const Node& node, std::string_view key,
                                                 FaultList& faults) const {
  const std::string* text = scalar_of(node, key, allowed, faults);
  if (text == nullptr) return std::nullopt;
  for (const auto& [unit, worth] : units) {
    if (!text->ends_with(unit)) continue;
    const auto digits = std::string_view(*text).substr(0, text->size() - unit.size());
    const auto number = fractions ? number_from(digits) : std::optional<double>(whole_from(digits));
    if (!number || (!fractions && *number < 0)) continue;
    const double size = *number * static_cast<double>(worth);
    if (size >= static_cast<double>(min) && size <= static_cast<double>(max))
      return static_cast<std::int64_t>(size);
    faults.add(node.position, fmt::format("{} '{}' {}", key, *text, outside), allowed);
    return std::nullopt;
  }
  faults.add(node.position, fmt::format("{} '{}' cannot be understood", key, *text), allowed);
  return std::nullopt;
}
std::string SizeRule::schema() const {
  return fmt::format(R"({{ "type": "string", "pattern": "^{}$" }})", pattern);
}

std::string NumberRule::schema() const {
  if (min == NumberRule{}.min) return R"({ "type": "number" })";
  return R"({ "type": "number", "minimum": )" + fieldcast::to_text(Value{min}) +
         R"(, "maximum": )" + fieldcast::to_text(Value{max}) + " }";
}
std::string NumberRule::form() const {
  if (min == NumberRule{}.min) return "a number";
  return fmt::format("{} to {}", fieldcast::to_text(Value{min}), fieldcast::to_text(Value{max}));
}

std::string FlagRule::schema() const { return R"({ "type": "boolean" })"; }
std::string FlagRule::form() const { return "`true`, `false`"; }

std::string TextRule::schema() const {
  return R"({ "type": ["string", "number", "boolean"], "minLength": 1, "maxLength": )" +
         std::to_string(max_bytes) + " }";
}
std::string TextRule::form() const { return fmt::format("up to {} bytes", max_bytes); }

std::string NameRule::schema() const { return R"({ "$ref": "#/$defs/word" })"; }
std::string NameRule::form() const { return {}; }

std::string schema_of_words(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) {
    const bool plain = word == "true" || word == "false" || whole_from(word);
    text += text.empty() ? "" : ", ";
    text += plain ? std::string(word) : fmt::format("\"{}\"", word);
  }
  return R"({ "enum": [)" + text + "] }";
}

std::string form_of_words(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words)
    text += fmt::format("{}{}`", text.empty() ? "`" : ", `", word);
  return text;
}

}  // namespace fieldcast::config
