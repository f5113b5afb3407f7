#include "config/document/text_number.hpp"

#include <fmt/format.h>

#include <array>

#include "config/document/scalars.hpp"

namespace fieldcast::config {
namespace {

constexpr std::array<std::pair<std::string_view, TextNumber::Kind>, 3> kWords{
    {{"decimal", TextNumber::Kind::kDecimal},
     {"decimal-comma", TextNumber::Kind::kDecimalComma},
     {"hex", TextNumber::Kind::kHex}}};

// "decimal(7)" or "decimal".
std::optional<TextForm> word_form(std::string_view text) {
  const auto open = text.find('(');
  for (const auto& [word, kind] : kWords) {
    if (text.substr(0, open) != word) continue;
    TextForm form;
    form.number.kind = kind;
    if (open == text.npos) return form;
    if (!text.ends_with(')')) return std::nullopt;
    const auto characters = whole_from(text.substr(open + 1, text.size() - open - 2));
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
  std::string meant;
  if (*text == "dec" || *text == "number" || *text == "true") meant = "decimal";
  if (*text == "comma") meant = "decimal-comma";
  if (meant.empty()) {
    const std::array<std::string_view, 3> words{kWords[0].first, kWords[1].first, kWords[2].first};
    meant = closest(text->substr(0, text->find('(')), words);
  }
  faults.add(node.position, fmt::format("{} '{}' cannot be understood", key, *text),
             std::string(kTextNumberForms), meant);
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
