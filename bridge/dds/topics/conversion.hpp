// Topic types from core types and back. Pure functions: nothing here knows a participant, a clock
// or a thread.
//
// Towards DDS everything that does not fit its bound is refused or cut by a stated rule; from DDS
// nothing is trusted: enumerators, union discriminants and numbers outside their range are refused.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/dds/topics/conversion_enums.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"
#include "bridge/standby/bus_claims.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"
#include "idl/topics.h"

namespace fieldcast {

inline constexpr std::size_t kMaxTextValue = 256;       // bytes of a string value: IDL string<256>
inline constexpr std::size_t kMaxCommandValues = 2048;  // IDL sequence<Value, 2048>

// ---- values

// False, and nothing written, for a string that is longer than kMaxTextValue or holds a NUL.
[[nodiscard]] bool to_idl(const Value& value, idl::Value& out);
// Nothing for a discriminant that the IDL does not name.
[[nodiscard]] std::optional<Value> from_idl(const idl::Value& value);

// ---- samples and catalogue

// Fills all but the keys. A value that does not fit becomes an empty string of quality BAD_RANGE,
// never a shortened one.
void to_idl(const Sample& sample, const UtcMapping& mapping, idl::Sample& out);
// Nothing for an unknown discriminant or quality.
[[nodiscard]] std::optional<StationSample> from_idl(const idl::Sample& sample);

// refresh: the promise in force. Texts are cut at their bounds, between characters.
void to_idl(std::string_view bridge, std::string_view bus, const DeviceSpec& device,
            const ChannelSpec& channel, std::optional<Duration> refresh, idl::Channel& out);
[[nodiscard]] StationChannel from_idl(const idl::Channel& channel);

// ---- commands

struct MalformedCommand {
  Cause cause = Cause::kUnsupported;
  std::string reason;  // one line for people
};
// `expires` is left at kNever: it depends on clocks.
[[nodiscard]] tl::expected<Command, MalformedCommand> from_idl(const idl::Command& command);
// False if a name or the list of values is too long.
[[nodiscard]] bool to_idl(std::string_view bus, const Command& command, idl::Command& out);

// A result's values beyond the bound are left out, and the reason says so; the reason itself is
// cut.
void to_idl(std::string_view bus, const CommandResult& result, const UtcMapping& mapping,
            idl::CommandResult& out);
[[nodiscard]] StationResult from_idl(const idl::CommandResult& result);

// Nothing for a refresh that is not positive or an empty name.
[[nodiscard]] std::optional<Interest> from_idl(const idl::Interest& interest);

// ---- status

void to_idl(std::string_view bridge, std::string_view bus, const BusReport& report, UtcTime at,
            idl::BusStatus& out);
void to_idl(std::string_view bus, std::string_view device, const DeviceReport& report, UtcTime at,
            idl::DeviceStatus& out);
[[nodiscard]] StationBusStatus from_idl(const idl::BusStatus& status);
[[nodiscard]] StationDeviceStatus from_idl(const idl::DeviceStatus& status);

void to_idl(const ProgramSessionReport& report, idl::ProgramSession& out);
[[nodiscard]] ProgramSessionReport from_idl(const idl::ProgramSession& session);

// ---- plans

inline constexpr std::size_t kPlanGroupsPerBlock = 64;   // IDL sequence<PlannedGroup, 64>
inline constexpr std::size_t kPlanPointsPerBlock = 128;  // of all its groups
inline constexpr std::size_t kMaxPlanBlocks = 6'250;     // what lies beyond is left out

// The plan in parts, at least one. `number` is greater than that of the plan before.
[[nodiscard]] std::vector<idl::ReadPlan> to_idl(std::string_view bus, const PlanReport& plan,
                                                std::uint64_t number, UtcTime since);
// Appends the groups of a part. REQUIRES: the parts before it were appended.
void append(const idl::ReadPlan& part, PlanReport& plan);

// ---- alarms

// All but the names.
void to_idl(const AlarmChange& change, const UtcMapping& mapping, idl::Alarm& out);
// Nothing for a limit that is no alarm's.
[[nodiscard]] std::optional<StationAlarm> from_idl(const idl::Alarm& alarm);

// Texts are cut at their bounds.
void to_idl(const AlarmKey& alarm, const AlarmStatus& status, idl::AlarmStatus& out);
// Nothing for an unknown enumerator, and for a limit that is no alarm's.
[[nodiscard]] std::optional<StationAlarmStatus> from_idl(const idl::AlarmStatus& status);

// False if a name or a text is too long.
[[nodiscard]] bool to_idl(const AlarmAction& action, idl::AlarmAction& out);
// Texts come out printable, and cut at their bounds. What the action means is checked by AlarmBook.
[[nodiscard]] tl::expected<AlarmAction, MalformedCommand> from_idl(const idl::AlarmAction& action);

// ---- bridges

// Buses beyond kMaxBuses are left out.
void to_idl(const BridgeClaims& claims, idl::Bridge& out);
[[nodiscard]] BridgeClaims from_idl(const idl::Bridge& bridge);
[[nodiscard]] StationBridge station_bridge(const idl::Bridge& bridge);

// The first `limit` bytes of a UTF-8 text, less where that would cut a character; ends before a
// NUL.
[[nodiscard]] std::string cut_text(std::string_view text, std::size_t limit);

}  // namespace fieldcast
