// Reads a list of texts of the configuration. Stateless.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxTexts = 64;  // entries of a list of names or sites
// Of its schema.
inline constexpr std::string_view kTextList =
    R"({ "type": "array", "items": { "type": "string" } })";

// `fault(text)` returns what is wrong, or an empty text.
template <typename Fault>
void read_texts(config::MapReader& map, std::string_view key, std::string_view form,
                std::vector<std::string>& target, Fault fault) {
  const config::Node* node = map.find(key);
  if (node == nullptr) return;
  if (node->kind != config::Kind::kList || node->items.size() > kMaxTexts) {
    const bool list = node->kind == config::Kind::kList;
    map.faults().add(
        node->position,
        fmt::format("{} is {}", key, list ? "too long" : std::string(config::to_text(node->kind))),
        fmt::format("a list of up to {}, each {}", kMaxTexts, form),
        node->kind == config::Kind::kScalar ? fmt::format("[\"{}\"]", node->text) : "");
    return;
  }
  target.clear();
  for (const config::Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, key, form, map.faults());
    if (text == nullptr) continue;
    if (const std::string wrong = fault(*text); !wrong.empty())
      map.faults().add(item->position, wrong, std::string(form));
    target.push_back(*text);
  }
}

}  // namespace fieldcast::web
