#include "bridge/reload_plan.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

const BusSpec* find_bus(const BridgeSpec& bridge, const std::string& name) {
  const auto found = std::find_if(bridge.buses.begin(), bridge.buses.end(), [&](const BusSpec& bus) { return bus.name == name; });
  return found == bridge.buses.end() ? nullptr : &*found;
}

}  // namespace

ReloadPlan plan_reload(const BridgeSpec& running, const BridgeSpec& wanted) {
  ReloadPlan plan;
  if (running.name != wanted.name || running.dds != wanted.dds || running.store != wanted.store) {
    plan.whole_bridge = true;
    return plan;
  }
  plan.program = running.program != wanted.program;
  for (const BusSpec& bus : running.buses) {
    const BusSpec* same = find_bus(wanted, bus.name);
    if (!same || *same != bus) plan.stop.push_back(bus.name);
  }
  for (const BusSpec& bus : wanted.buses) {
    const BusSpec* same = find_bus(running, bus.name);
    (same && *same == bus ? plan.untouched : plan.start).push_back(bus.name);
  }
  return plan;
}

}  // namespace fieldcast
