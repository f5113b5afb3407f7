#include "config/document/common_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "config/document/scalars.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

std::string code(std::string_view text) { return fmt::format("`{}`", text); }

void append(std::string& list, std::string_view separator, const std::string& word) {
  if (!list.empty()) list += separator;
  list += word;
}

// "usual; `name` other", with the protocols that differ.
template <typename TextOf>
std::string with_exceptions(const std::string& usual, const TextOf& text_of) {
  std::vector<std::pair<std::string, std::string>> others;  // value, protocols
  for (const ProtocolEntry& entry : protocols()) {
    const std::string text = text_of(entry);
    if (text == usual) continue;
    const auto known = std::ranges::find(others, text, [](const auto& each) { return each.first; });
    if (known == others.end())
      others.emplace_back(text, code(entry.name));
    else
      append(known->second, ", ", code(entry.name));
  }
  std::string all = usual;
  for (const auto& [text, names] : others) all += fmt::format("; {} {}", names, text);
  return all;
}

std::string baud_of(const LineFormat& line) { return std::to_string(line.baud); }
std::string format_of(const LineFormat& line) {
  const std::string text = to_text(line);
  return text.substr(text.find(' ') + 1);
}

}  // namespace

std::string options_text() {
  std::vector<std::pair<std::string_view, std::string>> all;  // text, protocols
  for (const ProtocolEntry& entry : protocols()) {
    if (entry.options_text.empty()) continue;
    const auto known =
        std::ranges::find(all, entry.options_text, [](const auto& each) { return each.first; });
    if (known == all.end())
      all.emplace_back(entry.options_text, std::string(entry.name));
    else
      append(known->second, ", ", std::string(entry.name));
  }
  std::string text;
  for (const auto& [options, names] : all)
    append(text, ". ", fmt::format("{}: {}", names, options));
  return text;
}

std::string factory_bauds() {
  return with_exceptions(baud_of({}),
                         [](const ProtocolEntry& entry) { return baud_of(entry.factory_line); });
}
std::string factory_formats() {
  return with_exceptions(format_of({}),
                         [](const ProtocolEntry& entry) { return format_of(entry.factory_line); });
}

std::string protocol_names() {
  std::string names;
  for (const ProtocolEntry& entry : protocols()) append(names, ", ", code(entry.name));
  return names;
}

std::string pipelined_protocol_names() {
  std::string names;
  for (const ProtocolEntry& entry : protocols()) {
    if (entry.first_frame != nullptr) append(names, ", ", std::string(entry.name));
  }
  return names;
}

namespace {

constexpr std::array<std::pair<std::string_view, TextNumber::Kind>, 3> kWords{
    {{"decimal", TextNumber::Kind::kDecimal},
     {"decimal-comma", TextNumber::Kind::kDecimalComma},
     {"hex", TextNumber::Kind::kHex}}};

// "7" of "decimal(7)"; empty without brackets.
std::string_view size_in(std::string_view text) {
  const auto open = text.find('(');
  if (open == text.npos || !text.ends_with(')')) return {};
  return text.substr(open + 1, text.size() - open - 2);
}

bool is_word_with_size(std::string_view text) {
  return !size_in(text).empty() && std::ranges::any_of(kWords, [&](const auto& row) {
    return text.substr(0, text.find('(')) == row.first;
  });
}

// "decimal(7)" or "decimal".
std::optional<TextForm> word_form(std::string_view text) {
  const auto open = text.find('(');
  for (const auto& [word, kind] : kWords) {
    if (text.substr(0, open) != word) continue;
    TextForm form;
    form.number.kind = kind;
    if (open == text.npos) return form;
    const auto characters = whole_from(size_in(text));
    if (!characters || *characters < 1 || *characters > kMaxTextCharacters) return std::nullopt;
    form.characters = static_cast<std::uint16_t>(*characters);
    return form;
  }
  return std::nullopt;
}

}  // namespace

std::optional<TextForm> TextFormRule::operator()(const Node& node, std::string_view key,
                                                 FaultList& faults) const {
  const std::string* text = scalar_of(node, key, kTextNumberForms, faults);
  if (text == nullptr) return std::nullopt;
  if (const auto form = word_form(*text)) return form;
  if (const auto picture = text_number_from_picture(*text))
    return TextForm{*picture, static_cast<std::uint16_t>(text->size())};
  if (is_word_with_size(*text)) {
    faults.add(node.position, fmt::format("text '{}' is not of n characters", *text),
               fmt::format("n of 1 to {}, as {}(7)", kMaxTextCharacters,
                           text->substr(0, text->find('('))));
    return std::nullopt;
  }
  std::string meant;
  if (*text == "dec" || *text == "number" || *text == "true") meant = "decimal";
  if (*text == "comma") meant = "decimal-comma";
  if (meant.empty()) {
    const std::array<std::string_view, 3> words{kWords[0].first, kWords[1].first, kWords[2].first};
    meant = closest(text->substr(0, text->find('(')), words);
    const std::string_view size = size_in(*text);
    if (!meant.empty() && !size.empty()) meant += fmt::format("({})", size);
  }
  faults.add(node.position, fmt::format("{} '{}' cannot be understood", key, *text),
             kTextNumberForms, meant);
  return std::nullopt;
}

std::string TextFormRule::schema() const {
  std::string words;
  for (const auto& [word, kind] : kWords) words += (words.empty() ? "" : "|") + std::string(word);
  return R"({ "type": "string", "pattern": "^(()" + words +
         R"()(\\([0-9]+\\))?|[+]?0+([.,]0+)?)$" })";
}
std::string TextFormRule::form() const { return {}; }

}  // namespace fieldcast::config
