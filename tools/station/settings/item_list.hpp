// Reads a list of named maps of the configuration. Stateless.
#pragma once

#include <fmt/format.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::web {

// Reads each map of the list `key`, whose `name` must be unique.
template <class Item, class Read>
void read_items(config::MapReader& map, std::string_view key, const config::Rows<Item>& rows,
                std::size_t most, std::vector<Item>& items, Read read) {
  const config::Node* node = map.find(key);
  if (node == nullptr ||
      !config::is_list(*node, key, 1, most, fmt::format("a list of up to {} maps", most),
                       map.faults()))
    return;
  std::set<std::string> names;
  for (const config::Node* each : node->items) {
    config::MapReader item(*each, rows, map.faults());
    read(item, items.emplace_back());
    const std::string& name = items.back().name;
    if (!name.empty() && !names.insert(name).second)
      item.fault("name", fmt::format("the name '{}' appears twice", name), "a unique name");
  }
}

}  // namespace fieldcast::web
