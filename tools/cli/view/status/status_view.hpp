// Other bridges that claim a bus in their messages on fieldcast/Bridge: those that also serve it,
// and those that wait because another bridge serves it. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {

struct BusClaimants {
  std::vector<const StationBridge*> serving;  // the bus is contested
  std::vector<const StationBridge*> waiting;  // the bus is refused to them
};
// Excludes the bridge that reports the bus and the members of its standby group.
[[nodiscard]] BusClaimants claimants_of(const StatusModel& model, const StationBusStatus& bus);

// One fact for each of the two kinds; empty if only one bridge claims the bus.
[[nodiscard]] std::vector<StatusFact> claim_facts(const StatusModel& model,
                                                  const StationBusStatus& bus);

// Adds "contested_by" and "waiting_bridges" with names and hosts, if there are any.
void add_claims(Json& line, const StatusModel& model, const StationBusStatus& bus);

// Facts of each bus, its devices as a table (bad ones first), and remarks. Wraps at the screen's
// width, or at 80 columns.
[[nodiscard]] std::vector<std::string> status_lines(const StatusModel& model, UtcTime now,
                                                    const Screen& screen);

// IDL field names, and "topic" with the type. Times in nanoseconds.
[[nodiscard]] Json status_json(const StationBusStatus& status);
[[nodiscard]] Json status_json(const StationDeviceStatus& status);

}  // namespace fieldcast::cli
