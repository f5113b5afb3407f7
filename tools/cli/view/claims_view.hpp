// Other bridges that claim a bus, by their messages on fieldcast/Bridge: those that say that they
// serve it, too, and those that do not serve it because another bridge does. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "tools/cli/view/status_facts.hpp"

namespace fieldcast::cli {

struct BusClaimants {
  std::vector<const StationBridge*> serving;  // the bus is contested
  std::vector<const StationBridge*> waiting;  // they are refused the bus
};
// Of the bridges in the model, without the one that reports the bus and the members of its standby
// group.
[[nodiscard]] BusClaimants claimants_of(const StatusModel& model, const StationBusStatus& bus);

// A line for each of the two kinds; empty if only one bridge claims the bus.
[[nodiscard]] std::vector<StatusFact> claim_facts(const StatusModel& model,
                                                  const StationBusStatus& bus);

// "contested_by" and "waiting_bridges" of the bus, if there are any: names and hosts.
void add_claims(Json& line, const StatusModel& model, const StationBusStatus& bus);

}  // namespace fieldcast::cli
