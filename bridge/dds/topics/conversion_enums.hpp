// Converts enumerators between core and the topics by name, never by number, which may differ. The
// switches have no default, so that the compiler reports an enumerator of core that has no name.
#pragma once

#include <optional>

#include "bridge/standby/standby_values.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/base/cause.hpp"
#include "core/model/channel_kind.hpp"
#include "core/model/command.hpp"
#include "core/model/status.hpp"
#include "idl/topics.h"

namespace fieldcast {

namespace idl = ::fieldcast_idl;

[[nodiscard]] idl::Quality to_idl(Quality value);
[[nodiscard]] idl::ValueType to_idl(ValueType value);
[[nodiscard]] idl::Access to_idl(Access value);
[[nodiscard]] idl::Mode to_idl(Mode value);
[[nodiscard]] idl::Operation to_idl(Operation value);
[[nodiscard]] idl::CommandState to_idl(CommandState value);
[[nodiscard]] idl::BusState to_idl(BusState value);
[[nodiscard]] idl::DeviceState to_idl(DeviceState value);
[[nodiscard]] idl::AlarmState to_idl(AlarmState value);
[[nodiscard]] idl::LimitKind to_idl(LimitKind value);
[[nodiscard]] idl::AlarmPriority to_idl(AlarmPriority value);
[[nodiscard]] idl::AlarmStage to_idl(AlarmStage value);
[[nodiscard]] idl::AlarmActionKind to_idl(AlarmActionKind value);
[[nodiscard]] idl::SessionState to_idl(ProgramSessionState value);
[[nodiscard]] idl::StandbyNoteKind to_idl(StandbyNoteKind value);

// Empty for a number that the IDL does not name, and for limits that do not raise alarms.
[[nodiscard]] std::optional<Quality> from_idl(idl::Quality value);
[[nodiscard]] std::optional<ValueType> from_idl(idl::ValueType value);
[[nodiscard]] std::optional<Access> from_idl(idl::Access value);
[[nodiscard]] std::optional<Mode> from_idl(idl::Mode value);
[[nodiscard]] std::optional<Operation> from_idl(idl::Operation value);
[[nodiscard]] std::optional<CommandState> from_idl(idl::CommandState value);
[[nodiscard]] std::optional<BusState> from_idl(idl::BusState value);
[[nodiscard]] std::optional<DeviceState> from_idl(idl::DeviceState value);
[[nodiscard]] std::optional<AlarmState> from_idl(idl::AlarmState value);
[[nodiscard]] std::optional<LimitKind> from_idl(idl::LimitKind value);
[[nodiscard]] std::optional<AlarmPriority> from_idl(idl::AlarmPriority value);
[[nodiscard]] std::optional<AlarmStage> from_idl(idl::AlarmStage value);
[[nodiscard]] std::optional<AlarmActionKind> from_idl(idl::AlarmActionKind value);
[[nodiscard]] std::optional<ProgramSessionState> from_idl(idl::SessionState value);
[[nodiscard]] std::optional<StandbyNoteKind> from_idl(idl::StandbyNoteKind value);

}  // namespace fieldcast
