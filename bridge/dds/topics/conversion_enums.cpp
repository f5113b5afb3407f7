#include "bridge/dds/topics/conversion_enums.hpp"

#include <array>
#include <cstdlib>

namespace fieldcast {

namespace {

constexpr std::optional<idl::Quality> idl_of(Quality value) {
  switch (value) {
    case Quality::kGood: return idl::Quality::GOOD;
    case Quality::kUncertain: return idl::Quality::UNCERTAIN;
    case Quality::kBadNoResponse: return idl::Quality::BAD_NO_ANSWER;
    case Quality::kBadFrame: return idl::Quality::BAD_FRAME;
    case Quality::kBadDeviceError: return idl::Quality::BAD_DEVICE_ERROR;
    case Quality::kBadRange: return idl::Quality::BAD_RANGE;
    case Quality::kBadConfiguration: return idl::Quality::BAD_CONFIGURATION;
    case Quality::kNotYetRead: return idl::Quality::NOT_YET_READ;
  }
  return std::nullopt;
}

constexpr std::optional<idl::ValueType> idl_of(ValueType value) {
  switch (value) {
    case ValueType::kBool: return idl::ValueType::TYPE_BOOL;
    case ValueType::kInt16: return idl::ValueType::TYPE_INT16;
    case ValueType::kUint16: return idl::ValueType::TYPE_UINT16;
    case ValueType::kInt32: return idl::ValueType::TYPE_INT32;
    case ValueType::kUint32: return idl::ValueType::TYPE_UINT32;
    case ValueType::kInt64: return idl::ValueType::TYPE_INT64;
    case ValueType::kUint64: return idl::ValueType::TYPE_UINT64;
    case ValueType::kFloat32: return idl::ValueType::TYPE_FLOAT32;
    case ValueType::kFloat64: return idl::ValueType::TYPE_FLOAT64;
    case ValueType::kBcd16: return idl::ValueType::TYPE_BCD16;
    case ValueType::kBcd32: return idl::ValueType::TYPE_BCD32;
    case ValueType::kString: return idl::ValueType::TYPE_STRING;
    case ValueType::kInt8: return idl::ValueType::TYPE_INT8;
    case ValueType::kUint8: return idl::ValueType::TYPE_UINT8;
    case ValueType::kBcd8: return idl::ValueType::TYPE_BCD8;
  }
  return std::nullopt;
}

constexpr std::optional<idl::Access> idl_of(Access value) {
  switch (value) {
    case Access::kReadOnly: return idl::Access::READ_ONLY;
    case Access::kReadWrite: return idl::Access::READ_WRITE;
    case Access::kWriteOnly: return idl::Access::WRITE_ONLY;
  }
  return std::nullopt;
}

constexpr std::optional<idl::Mode> idl_of(Mode value) {
  switch (value) {
    case Mode::kIntensive: return idl::Mode::INTENSIVE;
    case Mode::kScheduled: return idl::Mode::SCHEDULED;
    case Mode::kOnDemand: return idl::Mode::ON_DEMAND;
  }
  return std::nullopt;
}

constexpr std::optional<idl::Operation> idl_of(Operation value) {
  switch (value) {
    case Operation::kWrite: return idl::Operation::OPERATION_WRITE;
    case Operation::kAcquire: return idl::Operation::OPERATION_ACQUIRE;
  }
  return std::nullopt;
}

constexpr std::optional<idl::CommandState> idl_of(CommandState value) {
  switch (value) {
    case CommandState::kDone: return idl::CommandState::DONE;
    case CommandState::kVerified: return idl::CommandState::VERIFIED;
    case CommandState::kRejected: return idl::CommandState::REJECTED;
    case CommandState::kFailed: return idl::CommandState::FAILED;
    case CommandState::kExpired: return idl::CommandState::EXPIRED;
  }
  return std::nullopt;
}

constexpr std::optional<idl::BusState> idl_of(BusState value) {
  switch (value) {
    case BusState::kOpening: return idl::BusState::BUS_OPENING;
    case BusState::kRunning: return idl::BusState::BUS_RUNNING;
    case BusState::kClosed: return idl::BusState::BUS_CLOSED;
    case BusState::kLeased: return idl::BusState::BUS_LEASED;
    case BusState::kStopped: return idl::BusState::BUS_STOPPED;
  }
  return std::nullopt;
}

constexpr std::optional<idl::DeviceState> idl_of(DeviceState value) {
  switch (value) {
    case DeviceState::kUnknown: return idl::DeviceState::DEVICE_UNKNOWN;
    case DeviceState::kOnline: return idl::DeviceState::DEVICE_ONLINE;
    case DeviceState::kDegraded: return idl::DeviceState::DEVICE_DEGRADED;
    case DeviceState::kOffline: return idl::DeviceState::DEVICE_OFFLINE;
  }
  return std::nullopt;
}

constexpr std::optional<idl::AlarmState> idl_of(AlarmState value) {
  switch (value) {
    case AlarmState::kClear: return idl::AlarmState::ALARM_CLEAR;
    case AlarmState::kActive: return idl::AlarmState::ALARM_ACTIVE;
  }
  return std::nullopt;
}

constexpr std::optional<idl::LimitKind> idl_of(LimitKind value) {
  switch (value) {
    case LimitKind::kLowLow: return idl::LimitKind::LIMIT_LOW_LOW;
    case LimitKind::kLow: return idl::LimitKind::LIMIT_LOW;
    case LimitKind::kHigh: return idl::LimitKind::LIMIT_HIGH;
    case LimitKind::kHighHigh: return idl::LimitKind::LIMIT_HIGH_HIGH;
  }
  return std::nullopt;
}

constexpr std::optional<idl::AlarmPriority> idl_of(AlarmPriority value) {
  switch (value) {
    case AlarmPriority::kLow: return idl::AlarmPriority::PRIORITY_LOW;
    case AlarmPriority::kMedium: return idl::AlarmPriority::PRIORITY_MEDIUM;
    case AlarmPriority::kHigh: return idl::AlarmPriority::PRIORITY_HIGH;
    case AlarmPriority::kCritical: return idl::AlarmPriority::PRIORITY_CRITICAL;
  }
  return std::nullopt;
}

constexpr std::optional<idl::AlarmStage> idl_of(AlarmStage value) {
  switch (value) {
    case AlarmStage::kClear: return idl::AlarmStage::STAGE_CLEAR;
    case AlarmStage::kUnacknowledged: return idl::AlarmStage::STAGE_UNACKNOWLEDGED;
    case AlarmStage::kAcknowledged: return idl::AlarmStage::STAGE_ACKNOWLEDGED;
    case AlarmStage::kReturned: return idl::AlarmStage::STAGE_RETURNED;
  }
  return std::nullopt;
}

constexpr std::optional<idl::AlarmActionKind> idl_of(AlarmActionKind value) {
  switch (value) {
    case AlarmActionKind::kAcknowledge: return idl::AlarmActionKind::ACTION_ACKNOWLEDGE;
    case AlarmActionKind::kShelve: return idl::AlarmActionKind::ACTION_SHELVE;
    case AlarmActionKind::kUnshelve: return idl::AlarmActionKind::ACTION_UNSHELVE;
    case AlarmActionKind::kMaintenance: return idl::AlarmActionKind::ACTION_MAINTENANCE;
    case AlarmActionKind::kEndMaintenance: return idl::AlarmActionKind::ACTION_END_MAINTENANCE;
    case AlarmActionKind::kEndSession: return idl::AlarmActionKind::ACTION_END_SESSION;
  }
  return std::nullopt;
}

constexpr std::optional<idl::SessionState> idl_of(ProgramSessionState value) {
  switch (value) {
    case ProgramSessionState::kOpen: return idl::SessionState::SESSION_OPEN;
    case ProgramSessionState::kClosed: return idl::SessionState::SESSION_CLOSED;
    case ProgramSessionState::kRefused: return idl::SessionState::SESSION_REFUSED;
  }
  return std::nullopt;
}

constexpr std::optional<idl::StandbyNoteKind> idl_of(StandbyNoteKind value) {
  switch (value) {
    case StandbyNoteKind::kBegun: return idl::StandbyNoteKind::NOTE_BEGUN;
    case StandbyNoteKind::kReturned: return idl::StandbyNoteKind::NOTE_RETURNED;
    case StandbyNoteKind::kCompleted: return idl::StandbyNoteKind::NOTE_ANSWERED;
  }
  return std::nullopt;
}

// A value without a case is not an enumerator, which is a bug.
template <class Core>
auto named(Core value) {
  const auto found = idl_of(value);
  if (!found) std::abort();
  return *found;
}

// The reverse of idl_of().
template <class Core, class Idl>
std::optional<Core> core_of(Idl value) {
  constexpr std::size_t kMost = 16;  // enumerators
  static constexpr auto kCores = [] {
    std::array<std::optional<Core>, kMost> cores{};
    for (std::size_t i = 0; i < kMost; ++i) {
      if (const auto idl = idl_of(static_cast<Core>(i)))
        cores.at(static_cast<std::size_t>(*idl)) = static_cast<Core>(i);
    }
    return cores;
  }();
  const auto number = static_cast<std::size_t>(value);
  return number < kMost ? kCores[number] : std::nullopt;
}

}  // namespace

idl::Quality to_idl(Quality value) { return named(value); }
idl::ValueType to_idl(ValueType value) { return named(value); }
idl::Access to_idl(Access value) { return named(value); }
idl::Mode to_idl(Mode value) { return named(value); }
idl::Operation to_idl(Operation value) { return named(value); }
idl::CommandState to_idl(CommandState value) { return named(value); }
idl::BusState to_idl(BusState value) { return named(value); }
idl::DeviceState to_idl(DeviceState value) { return named(value); }
idl::AlarmState to_idl(AlarmState value) { return named(value); }
idl::LimitKind to_idl(LimitKind value) { return named(value); }
idl::AlarmPriority to_idl(AlarmPriority value) { return named(value); }
idl::AlarmStage to_idl(AlarmStage value) { return named(value); }
idl::AlarmActionKind to_idl(AlarmActionKind value) { return named(value); }
idl::SessionState to_idl(ProgramSessionState value) { return named(value); }
idl::StandbyNoteKind to_idl(StandbyNoteKind value) { return named(value); }

std::optional<Quality> from_idl(idl::Quality value) { return core_of<Quality>(value); }
std::optional<ValueType> from_idl(idl::ValueType value) { return core_of<ValueType>(value); }
std::optional<Access> from_idl(idl::Access value) { return core_of<Access>(value); }
std::optional<Mode> from_idl(idl::Mode value) { return core_of<Mode>(value); }
std::optional<Operation> from_idl(idl::Operation value) { return core_of<Operation>(value); }
std::optional<CommandState> from_idl(idl::CommandState value) {
  return core_of<CommandState>(value);
}
std::optional<BusState> from_idl(idl::BusState value) { return core_of<BusState>(value); }
std::optional<DeviceState> from_idl(idl::DeviceState value) { return core_of<DeviceState>(value); }
std::optional<AlarmState> from_idl(idl::AlarmState value) { return core_of<AlarmState>(value); }
std::optional<LimitKind> from_idl(idl::LimitKind value) { return core_of<LimitKind>(value); }
std::optional<AlarmPriority> from_idl(idl::AlarmPriority value) {
  return core_of<AlarmPriority>(value);
}
std::optional<AlarmStage> from_idl(idl::AlarmStage value) { return core_of<AlarmStage>(value); }
std::optional<AlarmActionKind> from_idl(idl::AlarmActionKind value) {
  return core_of<AlarmActionKind>(value);
}
std::optional<ProgramSessionState> from_idl(idl::SessionState value) {
  return core_of<ProgramSessionState>(value);
}
std::optional<StandbyNoteKind> from_idl(idl::StandbyNoteKind value) {
  return core_of<StandbyNoteKind>(value);
}

}  // namespace fieldcast
