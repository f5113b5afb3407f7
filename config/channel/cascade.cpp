#include "config/channel/cascade.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {
// allow: [raw-read, raw-write].
void read_allow(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("allow");
  if (node == nullptr) return;
  static constexpr std::pair<std::string_view, int> kRights[] = {{"raw-read", 0}, {"raw-write", 1}};
  if (node->kind != Kind::kList) {
    map.faults().add(node->position, fmt::format("allow is {}", to_text(node->kind)),
                     "a list of raw-read, raw-write",
                     node->kind == Kind::kScalar ? '[' + node->text + ']' : "");
    return;
  }
  defaults.spec.allow_raw_read = defaults.spec.allow_raw_write = false;
  for (const Node* item : node->items) {
    const auto right = ChoiceRule<int>{kRights}(*item, "allow", map.faults());
    if (right) (*right == 0 ? defaults.spec.allow_raw_read : defaults.spec.allow_raw_write) = true;
  }
}

// options: { name: value }.
void read_options(MapReader& map, DeviceDefaults& defaults) {
  const Node* node = map.find("options");
  if (node == nullptr) return;
  if (node->kind != Kind::kMap || node->entries.size() > kMaxOptions) {
    map.faults().add(node->position,
                     node->kind == Kind::kMap ? "too many options"
                                              : fmt::format("options is {}", to_text(node->kind)),
                     fmt::format("a map of at most {} options of the protocol", kMaxOptions));
    return;
  }
  for (const auto& [key, value] : node->entries) {
    const auto text = TextRule{kMaxDescription}(*value, key->text, map.faults());
    if (!text) continue;
    defaults.options.texts[key->text] = *text;
    defaults.options.positions[key->text] = key->position;
  }
}

}  // namespace fieldcast::config
