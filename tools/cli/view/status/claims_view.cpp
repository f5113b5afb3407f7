#include "tools/cli/view/status/claims_view.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::cli {
namespace {

constexpr std::size_t kNamedBridges = 3;  // of one kind; further bridges are only counted

std::string named(const std::vector<const StationBridge*>& bridges) {
  std::string text;
  for (std::size_t i = 0; i < std::min(bridges.size(), kNamedBridges); ++i)
    text += fmt::format("{}bridge {} on host {}", i == 0 ? "" : ", ", bridges[i]->bridge,
                        bridges[i]->host);
  if (bridges.size() > kNamedBridges)
    text += fmt::format(" and {} more", bridges.size() - kNamedBridges);
  return text;
}

Json claimants_json(const std::vector<const StationBridge*>& bridges) {
  Json all = Json::array();
  for (const StationBridge* each : bridges)
    all.push_back({{"bridge", each->bridge}, {"host", each->host}});
  return all;
}

}  // namespace

BusClaimants claimants_of(const StatusModel& model, const StationBusStatus& bus) {
  const auto own = model.bridges.find(bus.bridge);
  const std::string group = own == model.bridges.end() ? "" : own->second.standby_group;
  BusClaimants found;
  for (const auto& [name, bridge] : model.bridges) {
    if (name == bus.bridge || (!group.empty() && bridge.standby_group == group)) continue;
    const auto claim = std::ranges::find(bridge.buses, bus.bus, &StationBridge::Bus::bus);
    if (claim == bridge.buses.end()) continue;
    (claim->serving ? found.serving : found.waiting).push_back(&bridge);
  }
  return found;
}

std::vector<StatusFact> claim_facts(const StatusModel& model, const StationBusStatus& bus) {
  const BusClaimants others = claimants_of(model, bus);
  std::vector<StatusFact> facts;
  if (!others.serving.empty()) {
    facts.push_back(
        {"claims",
         fmt::format("contested: {} also claims to serve bus {}, whose name must be unique in the "
                     "DDS domain; stop or rename one of them",
                     named(others.serving), bus.bus),
         Tone::kBad});
  }
  if (!others.waiting.empty()) {
    facts.push_back(
        {"claims",
         fmt::format("refused: {} has a bus of this name and does not serve it, because bridge "
                     "{} does; rename one of the buses",
                     named(others.waiting), bus.bridge),
         Tone::kWarning});
  }
  return facts;
}

void add_claims(Json& line, const StatusModel& model, const StationBusStatus& bus) {
  const BusClaimants others = claimants_of(model, bus);
  if (!others.serving.empty()) line.add("contested_by", claimants_json(others.serving));
  if (!others.waiting.empty()) line.add("waiting_bridges", claimants_json(others.waiting));
}

}  // namespace fieldcast::cli
