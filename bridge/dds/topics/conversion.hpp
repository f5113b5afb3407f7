// Converts topic types from core types and back. Pure. Towards DDS, a value that exceeds its bound
// is rejected or cut by a documented rule. Data from DDS is not trusted: enumerators, union
// discriminants and numbers outside their range are rejected.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "bridge/dds/topics/conversion_enums.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/standby/bus_claims.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/alarm/alarm_monitor.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "idl/topics.h"

namespace fieldcast {

inline constexpr std::size_t kMaxTextValue = 256;  // bytes of a string value: IDL string<256>
inline constexpr std::size_t kMaxDescribedChannels = 2048;  // IDL sequence<ChannelDigits, 2048>
inline constexpr std::size_t kMaxCommandValues = 2048;      // IDL sequence<Value, 2048>

// ---- values

// Returns false, and writes nothing, for a text longer than kMaxTextValue or with a NUL.
[[nodiscard]] bool to_idl(const Value& value, idl::Value& out);
// Returns `std::nullopt` for a discriminant that the IDL does not name.
[[nodiscard]] std::optional<Value> from_idl(const idl::Value& value);

// ---- samples and catalogue

// Fills all but the keys. A value that does not fit becomes an empty text of quality BAD_RANGE.
void to_idl(const Sample& sample, const UtcMapping& mapping, idl::Sample& out);
// Returns `std::nullopt` for an unknown discriminant or quality.
[[nodiscard]] std::optional<StationSample> from_idl(const idl::Sample& sample);

// `refresh` is the promise in force. Texts are cut at their bounds, between characters.
void to_idl(std::string_view bridge, std::string_view bus, const DeviceSpec& device,
            const ChannelSpec& channel, std::optional<Duration> refresh, idl::Channel& out);
[[nodiscard]] StationChannel from_idl(const idl::Channel& channel);

// ---- commands

struct MalformedCommand {
  Cause cause = Cause::kUnsupported;
  std::string reason;  // one human-readable line
};
// `expires` remains kNever, because it depends on clocks.
[[nodiscard]] tl::expected<Command, MalformedCommand> from_idl(const idl::Command& command);
// Returns false if a name or the list of values is too long.
[[nodiscard]] bool to_idl(std::string_view bus, const Command& command, idl::Command& out);

// Values beyond the bound are omitted, which the reason states; the reason itself is cut.
void to_idl(std::string_view bus, const CommandResult& result, const UtcMapping& mapping,
            idl::CommandResult& out);
[[nodiscard]] StationResult from_idl(const idl::CommandResult& result);

// Returns `std::nullopt` for a refresh that is not positive or an empty name.
[[nodiscard]] std::optional<Interest> from_idl(const idl::Interest& interest);

// ---- status

void to_idl(std::string_view bridge, std::string_view bus, const BusReport& report, UtcTime at,
            idl::BusStatus& out);
void to_idl(std::string_view bus, std::string_view device, const DeviceReport& report, UtcTime at,
            idl::DeviceStatus& out);
[[nodiscard]] StationBusStatus from_idl(const idl::BusStatus& status);
[[nodiscard]] StationDeviceStatus from_idl(const idl::DeviceStatus& status);

// Texts are cut at their bounds.
void to_idl(std::string_view bridge, const BusSpec& bus, const DeviceSpec& device,
            idl::DeviceDescription& out);
[[nodiscard]] StationDeviceDescription from_idl(const idl::DeviceDescription& description);

void to_idl(const ProgramSessionReport& report, idl::ProgramSession& out);
[[nodiscard]] ProgramSessionReport from_idl(const idl::ProgramSession& session);
void to_idl(const ProgramRequestReport& report, idl::ProgramRequest& out);
[[nodiscard]] ProgramRequestReport from_idl(const idl::ProgramRequest& request);
void to_idl(const AuditReport& report, idl::Audit& out);
[[nodiscard]] AuditReport from_idl(const idl::Audit& audit);

// ---- plans

inline constexpr std::size_t kPlanGroupsPerBlock = 64;   // IDL sequence<PlannedGroup, 64>
inline constexpr std::size_t kPlanPointsPerBlock = 128;  // of all its groups
inline constexpr std::size_t kMaxPlanBlocks = 6'250;     // further blocks are omitted

// Converts the plan to parts, at least one. `number` must be greater than that of the earlier plan.
[[nodiscard]] std::vector<idl::ReadPlan> to_idl(std::string_view bus, const PlanReport& plan,
                                                std::uint64_t number, UtcTime since);
// Appends the groups of a part. REQUIRES: the parts before it were appended.
void append(const idl::ReadPlan& part, PlanReport& plan);

// ---- alarms

// Fills everything except the names.
void to_idl(const AlarmChange& change, const UtcMapping& mapping, idl::Alarm& out);
// Returns `std::nullopt` for a limit that does not raise alarms.
[[nodiscard]] std::optional<StationAlarm> from_idl(const idl::Alarm& alarm);

// Texts are cut at their bounds.
void to_idl(const AlarmKey& alarm, const AlarmStatus& status, idl::AlarmStatus& out);
// Returns `std::nullopt` for an unknown enumerator, and for a limit that does not raise alarms.
[[nodiscard]] std::optional<StationAlarmStatus> from_idl(const idl::AlarmStatus& status);

// Returns false if a name or a text is too long.
[[nodiscard]] bool to_idl(const AlarmAction& action, idl::AlarmAction& out);
// Texts are made printable and cut at their bounds. AlarmRegistry validates the action itself.
[[nodiscard]] tl::expected<AlarmAction, MalformedCommand> from_idl(const idl::AlarmAction& action);

// ---- bridges

// Buses beyond kMaxBuses are omitted.
void to_idl(const BridgeClaims& claims, idl::Bridge& out);
[[nodiscard]] BridgeClaims from_idl(const idl::Bridge& bridge);
[[nodiscard]] StationBridge station_bridge(const idl::Bridge& bridge);

// The value of a message; empty if from_idl() rejects the message.
template <class Message>
[[nodiscard]] auto value_of(const Message& message) -> decltype(std::optional(from_idl(message))) {
  return std::optional(from_idl(message));
}
// The type of value_of().
template <class Message>
using ValueOf = typename decltype(value_of(std::declval<const Message&>()))::value_type;
template <class Message>
concept HasValue = requires(const Message& message) {
  value_of(message);
};

// The first `limit` bytes of a UTF-8 text, fewer if that would cut a character; ends before a NUL.
[[nodiscard]] std::string cut_text(std::string_view text, std::size_t limit);

// Messages of a standby group; texts are cut at their bounds.

namespace idl = ::fieldcast_idl;

void to_idl(const StandbyMessage& message, idl::Standby& out);
// Returns `std::nullopt` for an unknown role.
[[nodiscard]] std::optional<StandbyMessage> from_idl(const idl::Standby& message);

void to_idl(const StandbyNote& note, idl::StandbyNote& out);
[[nodiscard]] StandbyNote from_idl(const idl::StandbyNote& note);

void to_idl(const StandbyRequest& request, idl::StandbyRequest& out);
[[nodiscard]] StandbyRequest from_idl(const idl::StandbyRequest& request);

}  // namespace fieldcast
