// What a new configuration means for a bridge that runs: decided here, done by Bridge. Pure.
#pragma once

#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast {

struct ReloadPlan {
  bool whole_bridge = false;           // the name, the DDS settings or the store differ: everything starts anew, the lists are empty
  bool program = false;                // the programming server starts anew; pairings end, buses go on
  std::vector<std::string> stop;       // buses that are gone or changed, in their old order
  std::vector<std::string> start;      // buses that are new or changed, in their new order
  std::vector<std::string> untouched;  // buses that keep running
  [[nodiscard]] bool nothing() const { return !whole_bridge && !program && stop.empty() && start.empty(); }
};

// REQUIRES: names of buses are unique in each of the two.
[[nodiscard]] ReloadPlan plan_reload(const BridgeSpec& running, const BridgeSpec& wanted);

}  // namespace fieldcast
