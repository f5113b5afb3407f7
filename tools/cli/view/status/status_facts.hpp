// Named facts of buses and devices for the screens and the text of `fieldcast status`. Pure
// functions.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridge/station/station.hpp"
#include "tools/cli/text/text_table.hpp"
#include "tools/cli/view/status/standby_view.hpp"

namespace fieldcast::cli {

struct StatusModel {
  std::map<std::string, StationBusStatus> buses;
  std::map<std::pair<std::string, std::string>, StationDeviceStatus> devices;  // by bus and name
  StandbyModel members;                                                        // of standby groups
  std::map<std::string, StationBridge> bridges;  // by name; with the buses that each claims
};

struct StatusFact {
  std::string_view name;  // "wire"
  std::string text;       // "busy 73.1 % of the last second; ..."; not yet printable()
  Tone tone = Tone::kPlain;
};

[[nodiscard]] Tone tone_of(BusState state);
[[nodiscard]] Tone tone_of(DeviceState state);

// The state and its reason are first. Unimportant facts are omitted.
[[nodiscard]] std::vector<StatusFact> bus_facts(const StationBusStatus& bus);
// `bus` is null if unknown.
[[nodiscard]] std::vector<StatusFact> device_facts(const StationDeviceStatus& device,
                                                   const StationBusStatus* bus);

// "73.1 %", "2.15 ms"; "-" for no time.
[[nodiscard]] std::string percent_text(double share);
[[nodiscard]] std::string milliseconds_text(Duration time);
// "CHECKSUM 3, NO_ANSWER 12"
[[nodiscard]] std::string causes_text(const CauseCounts& causes);

}  // namespace fieldcast::cli
