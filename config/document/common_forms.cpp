#include "config/document/common_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

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

}  // namespace fieldcast::config
