// Adds a fault for the second use of a name.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "config/document/document.hpp"
#include "config/document/fault_list.hpp"

namespace fieldcast::config {

class UniqueNames {
 public:
  // Ignores an empty name, which already has a fault.
  void add(std::string_view what, const std::string& name, const Position& position,
           FaultList& faults) {
    if (name.empty()) return;
    const auto [first, fresh] = positions_.emplace(name, position);
    if (fresh) return;
    const Position& there = first->second;
    const std::string file = there.source == position.source ? "" : there.source->file + ", ";
    faults.add(position, std::string(what) + " '" + name + "' exists already (" + file + "line " +
                             std::to_string(there.line + 1) + ')');
  }

 private:
  std::map<std::string, Position> positions_;
};

}  // namespace fieldcast::config
