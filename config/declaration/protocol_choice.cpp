#include "config/declaration/protocol_choice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declaration.hpp"
#include "config/document/scalars.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

ProtocolChoice read_protocol(const Node& node, std::string_view key, LoadState& state) {
  std::vector<std::string> names;
  for (const auto& entry : protocols()) names.emplace_back(entry.name);
  const auto listed = [&] { return std::vector<std::string_view>(names.begin(), names.end()); };
  const std::string* text =
      scalar_of(node, key, joined(listed()) + ", or the name of a declaration", state.faults);
  if (text == nullptr) return {};
  if (const auto* entry = find_protocol(*text)) return {*text, entry, {}};
  const auto found = state.library.protocol_declaration(node);
  if (!found.exists) {
    for (auto& name : state.library.declared_protocols(node)) names.push_back(std::move(name));
    const auto meant = meant_value("protocol", *text);
    state.faults.add(node.position, fmt::format("{} '{}' is unknown", key, *text), joined(listed()),
                     meant.empty() ? closest(*text, listed()) : meant);
    return {};
  }
  if (found.root == nullptr) return {};
  const auto [known, fresh] = state.declarations.try_emplace(found.root);
  if (fresh) known->second = read_declaration(*found.root, *text, state.faults);
  if (!known->second) return {};
  return {*text, nullptr, known->second};
}

}  // namespace fieldcast::config
