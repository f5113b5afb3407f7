#include "tools/import/text/tree.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/fault_list.hpp"
#include "tools/import/text/number.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

Tree read_yaml_tree(std::string_view text) {
  config::FaultList faults;
  auto document = config::parse_yaml(config::Source{.file = "", .text = std::string(text)}, faults);
  if (!faults.empty()) {
    const config::Fault fault = faults.take().front();
    return tl::unexpected("line " + std::to_string(fault.line) + ": " + fault.what);
  }
  if (document->root == nullptr) return tl::unexpected(std::string("it is empty"));
  return document;
}

const Node* child(const Node& map, std::string_view key) {
  if (map.kind != config::Kind::kMap) return nullptr;
  const auto found = std::ranges::find_if(
      map.entries, [&](const Node::Entry& entry) { return entry.key->text == key; });
  return found == map.entries.end() ? nullptr : found->value;
}

std::string_view text_of(const Node* node) {
  if (node == nullptr || node->kind != config::Kind::kScalar) return {};
  return node->text;
}

std::string_view text_at(const Node& map, std::string_view key) { return text_of(child(map, key)); }

std::optional<double> number_at(const Node& map, std::string_view key) {
  return number_from(text_at(map, key));
}

std::optional<std::string> fault_of_number(const Node& map, std::string_view key) {
  const std::string_view text = text_at(map, key);
  if (text.empty() || number_from(text)) return std::nullopt;
  return fmt::format("{} '{}' is no number", key, text);
}

std::optional<std::uint64_t> whole_at(const Node& map, std::string_view key) {
  return whole_from(text_at(map, key));
}

std::optional<bool> bool_at(const Node& map, std::string_view key) {
  const std::string word = lower(text_at(map, key));
  if (word.empty()) return std::nullopt;
  return word == "true" || word == "yes" || word == "on" || word == "1";
}

bool is_list(const Node* node) { return node != nullptr && node->kind == config::Kind::kList; }
bool is_map(const Node* node) { return node != nullptr && node->kind == config::Kind::kMap; }

}  // namespace fieldcast::importing
