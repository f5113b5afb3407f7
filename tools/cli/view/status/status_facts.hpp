#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridge/standby/standby_values.hpp"
#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

using StandbyModel = std::map<std::pair<std::string, std::string>, StandbyMessage>;

[[nodiscard]] Tone tone_of(const StandbyMessage& member);
// The master of the greatest term, also during a handover; null: the group has none.
[[nodiscard]] const StandbyMessage* master_of(const StandbyModel& model, const std::string& group);

[[nodiscard]] std::vector<std::string> standby_lines(const StandbyModel& model,
                                                     const Screen& screen);

// The fields of Standby by their IDL names, and "topic".
[[nodiscard]] Json standby_json(const StandbyMessage& message);

// Blocks of the master that a waiting member has not received yet.
[[nodiscard]] std::uint64_t behind(const StandbyModel& model, const StandbyMessage& member);

struct StatusModel {
  std::map<std::string, StationBusStatus> buses;
  std::map<std::pair<std::string, std::string>, StationDeviceStatus> devices;  // by bus and name
  StandbyModel members;                                                        // of standby groups
  std::map<std::string, StationBridge> bridges;  // by name; with the buses that each claims
};

// Named facts of buses and devices for the screens and the text of `fieldcast status`. Pure
// functions.
struct StatusFact {
  std::string_view name;  // "wire"
  std::string text;       // "busy 73.1 % of the last second; ..."; not yet printable()
  Tone tone = Tone::kPlain;
};

[[nodiscard]] Tone tone_of(BusState state);
[[nodiscard]] Tone tone_of(DeviceState state);

// The state and its reason are first. Unimportant facts are omitted.
[[nodiscard]] std::vector<StatusFact> bus_facts(const StationBusStatus& bus);
[[nodiscard]] std::vector<StatusFact> device_facts(const StationDeviceStatus& device,
                                                   const StationBusStatus* bus);

[[nodiscard]] std::string percent_text(double share);
[[nodiscard]] std::string milliseconds_text(Duration time);
// "CHECKSUM 3, NO_ANSWER 12"
[[nodiscard]] std::string causes_text(const CauseCounts& causes);

// "master", "waiting", "not ready": short text for a column.
[[nodiscard]] std::string role_text(const StandbyMessage& member);

// The state is first: the master, or why a member does not take over.
[[nodiscard]] std::vector<StatusFact> group_facts(const StandbyModel& model,
                                                  const std::string& group);
[[nodiscard]] std::vector<StatusFact> member_facts(const StandbyModel& model,
                                                   const StandbyMessage& member);

}  // namespace fieldcast::cli
