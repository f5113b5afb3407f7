#include "bridge/dds/topics/conversion_enums.hpp"

#include <cstdlib>

namespace fieldcast {

// A value that passes a switch of to_idl() is not an enumerator, which is a bug.

idl::Quality to_idl(Quality value) {
  switch (value) {
    case Quality::kGood: return idl::GOOD;
    case Quality::kUncertain: return idl::UNCERTAIN;
    case Quality::kBadNoAnswer: return idl::BAD_NO_ANSWER;
    case Quality::kBadFrame: return idl::BAD_FRAME;
    case Quality::kBadDeviceError: return idl::BAD_DEVICE_ERROR;
    case Quality::kBadRange: return idl::BAD_RANGE;
    case Quality::kBadConfiguration: return idl::BAD_CONFIGURATION;
    case Quality::kNotYetRead: return idl::NOT_YET_READ;
  }
  std::abort();
}

std::optional<Quality> from_idl(idl::Quality value) {
  switch (value) {
    case idl::GOOD: return Quality::kGood;
    case idl::UNCERTAIN: return Quality::kUncertain;
    case idl::BAD_NO_ANSWER: return Quality::kBadNoAnswer;
    case idl::BAD_FRAME: return Quality::kBadFrame;
    case idl::BAD_DEVICE_ERROR: return Quality::kBadDeviceError;
    case idl::BAD_RANGE: return Quality::kBadRange;
    case idl::BAD_CONFIGURATION: return Quality::kBadConfiguration;
    case idl::NOT_YET_READ: return Quality::kNotYetRead;
  }
  return std::nullopt;
}

idl::ValueType to_idl(ValueType value) {
  switch (value) {
    case ValueType::kBool: return idl::TYPE_BOOL;
    case ValueType::kInt16: return idl::TYPE_INT16;
    case ValueType::kUint16: return idl::TYPE_UINT16;
    case ValueType::kInt32: return idl::TYPE_INT32;
    case ValueType::kUint32: return idl::TYPE_UINT32;
    case ValueType::kInt64: return idl::TYPE_INT64;
    case ValueType::kUint64: return idl::TYPE_UINT64;
    case ValueType::kFloat32: return idl::TYPE_FLOAT32;
    case ValueType::kFloat64: return idl::TYPE_FLOAT64;
    case ValueType::kBcd16: return idl::TYPE_BCD16;
    case ValueType::kBcd32: return idl::TYPE_BCD32;
    case ValueType::kString: return idl::TYPE_STRING;
    case ValueType::kInt8: return idl::TYPE_INT8;
    case ValueType::kUint8: return idl::TYPE_UINT8;
    case ValueType::kBcd8: return idl::TYPE_BCD8;
  }
  std::abort();
}

std::optional<ValueType> from_idl(idl::ValueType value) {
  switch (value) {
    case idl::TYPE_BOOL: return ValueType::kBool;
    case idl::TYPE_INT16: return ValueType::kInt16;
    case idl::TYPE_UINT16: return ValueType::kUint16;
    case idl::TYPE_INT32: return ValueType::kInt32;
    case idl::TYPE_UINT32: return ValueType::kUint32;
    case idl::TYPE_INT64: return ValueType::kInt64;
    case idl::TYPE_UINT64: return ValueType::kUint64;
    case idl::TYPE_FLOAT32: return ValueType::kFloat32;
    case idl::TYPE_FLOAT64: return ValueType::kFloat64;
    case idl::TYPE_BCD16: return ValueType::kBcd16;
    case idl::TYPE_BCD32: return ValueType::kBcd32;
    case idl::TYPE_STRING: return ValueType::kString;
    case idl::TYPE_INT8: return ValueType::kInt8;
    case idl::TYPE_UINT8: return ValueType::kUint8;
    case idl::TYPE_BCD8: return ValueType::kBcd8;
  }
  return std::nullopt;
}

idl::Access to_idl(Access value) {
  switch (value) {
    case Access::kReadOnly: return idl::READ_ONLY;
    case Access::kReadWrite: return idl::READ_WRITE;
    case Access::kWriteOnly: return idl::WRITE_ONLY;
  }
  std::abort();
}

std::optional<Access> from_idl(idl::Access value) {
  switch (value) {
    case idl::READ_ONLY: return Access::kReadOnly;
    case idl::READ_WRITE: return Access::kReadWrite;
    case idl::WRITE_ONLY: return Access::kWriteOnly;
  }
  return std::nullopt;
}

idl::Mode to_idl(Mode value) {
  switch (value) {
    case Mode::kIntensive: return idl::INTENSIVE;
    case Mode::kScheduled: return idl::SCHEDULED;
    case Mode::kOnDemand: return idl::ON_DEMAND;
  }
  std::abort();
}

std::optional<Mode> from_idl(idl::Mode value) {
  switch (value) {
    case idl::INTENSIVE: return Mode::kIntensive;
    case idl::SCHEDULED: return Mode::kScheduled;
    case idl::ON_DEMAND: return Mode::kOnDemand;
  }
  return std::nullopt;
}

idl::Operation to_idl(Operation value) {
  switch (value) {
    case Operation::kWrite: return idl::OPERATION_WRITE;
    case Operation::kAcquire: return idl::OPERATION_ACQUIRE;
  }
  std::abort();
}

std::optional<Operation> from_idl(idl::Operation value) {
  switch (value) {
    case idl::OPERATION_WRITE: return Operation::kWrite;
    case idl::OPERATION_ACQUIRE: return Operation::kAcquire;
  }
  return std::nullopt;
}

idl::CommandState to_idl(CommandState value) {
  switch (value) {
    case CommandState::kDone: return idl::DONE;
    case CommandState::kVerified: return idl::VERIFIED;
    case CommandState::kRejected: return idl::REJECTED;
    case CommandState::kFailed: return idl::FAILED;
    case CommandState::kExpired: return idl::EXPIRED;
  }
  std::abort();
}

std::optional<CommandState> from_idl(idl::CommandState value) {
  switch (value) {
    case idl::DONE: return CommandState::kDone;
    case idl::VERIFIED: return CommandState::kVerified;
    case idl::REJECTED: return CommandState::kRejected;
    case idl::FAILED: return CommandState::kFailed;
    case idl::EXPIRED: return CommandState::kExpired;
  }
  return std::nullopt;
}

idl::BusState to_idl(BusState value) {
  switch (value) {
    case BusState::kOpening: return idl::BUS_OPENING;
    case BusState::kRunning: return idl::BUS_RUNNING;
    case BusState::kClosed: return idl::BUS_CLOSED;
    case BusState::kLeased: return idl::BUS_LEASED;
    case BusState::kStopped: return idl::BUS_STOPPED;
  }
  std::abort();
}

std::optional<BusState> from_idl(idl::BusState value) {
  switch (value) {
    case idl::BUS_OPENING: return BusState::kOpening;
    case idl::BUS_RUNNING: return BusState::kRunning;
    case idl::BUS_CLOSED: return BusState::kClosed;
    case idl::BUS_LEASED: return BusState::kLeased;
    case idl::BUS_STOPPED: return BusState::kStopped;
  }
  return std::nullopt;
}

idl::DeviceState to_idl(DeviceState value) {
  switch (value) {
    case DeviceState::kUnknown: return idl::DEVICE_UNKNOWN;
    case DeviceState::kOnline: return idl::DEVICE_ONLINE;
    case DeviceState::kDegraded: return idl::DEVICE_DEGRADED;
    case DeviceState::kOffline: return idl::DEVICE_OFFLINE;
  }
  std::abort();
}

std::optional<DeviceState> from_idl(idl::DeviceState value) {
  switch (value) {
    case idl::DEVICE_UNKNOWN: return DeviceState::kUnknown;
    case idl::DEVICE_ONLINE: return DeviceState::kOnline;
    case idl::DEVICE_DEGRADED: return DeviceState::kDegraded;
    case idl::DEVICE_OFFLINE: return DeviceState::kOffline;
  }
  return std::nullopt;
}

idl::AlarmState to_idl(AlarmState value) {
  switch (value) {
    case AlarmState::kClear: return idl::ALARM_CLEAR;
    case AlarmState::kActive: return idl::ALARM_ACTIVE;
  }
  std::abort();
}

std::optional<AlarmState> from_idl(idl::AlarmState value) {
  switch (value) {
    case idl::ALARM_CLEAR: return AlarmState::kClear;
    case idl::ALARM_ACTIVE: return AlarmState::kActive;
  }
  return std::nullopt;
}

idl::LimitKind to_idl(LimitKind value) {
  switch (value) {
    case LimitKind::kLowLow: return idl::LIMIT_LOW_LOW;
    case LimitKind::kLow: return idl::LIMIT_LOW;
    case LimitKind::kHigh: return idl::LIMIT_HIGH;
    case LimitKind::kHighHigh: return idl::LIMIT_HIGH_HIGH;
  }
  std::abort();
}

std::optional<LimitKind> from_idl(idl::LimitKind value) {
  switch (value) {
    case idl::LIMIT_LOW_LOW: return LimitKind::kLowLow;
    case idl::LIMIT_LOW: return LimitKind::kLow;
    case idl::LIMIT_HIGH: return LimitKind::kHigh;
    case idl::LIMIT_HIGH_HIGH: return LimitKind::kHighHigh;
    case idl::LIMIT_WRITE_MIN:
    case idl::LIMIT_WRITE_MAX: break;
  }
  return std::nullopt;
}

idl::AlarmPriority to_idl(AlarmPriority value) {
  switch (value) {
    case AlarmPriority::kLow: return idl::PRIORITY_LOW;
    case AlarmPriority::kMedium: return idl::PRIORITY_MEDIUM;
    case AlarmPriority::kHigh: return idl::PRIORITY_HIGH;
    case AlarmPriority::kCritical: return idl::PRIORITY_CRITICAL;
  }
  std::abort();
}

std::optional<AlarmPriority> from_idl(idl::AlarmPriority value) {
  switch (value) {
    case idl::PRIORITY_LOW: return AlarmPriority::kLow;
    case idl::PRIORITY_MEDIUM: return AlarmPriority::kMedium;
    case idl::PRIORITY_HIGH: return AlarmPriority::kHigh;
    case idl::PRIORITY_CRITICAL: return AlarmPriority::kCritical;
  }
  return std::nullopt;
}

idl::AlarmStage to_idl(AlarmStage value) {
  switch (value) {
    case AlarmStage::kClear: return idl::STAGE_CLEAR;
    case AlarmStage::kUnacknowledged: return idl::STAGE_UNACKNOWLEDGED;
    case AlarmStage::kAcknowledged: return idl::STAGE_ACKNOWLEDGED;
    case AlarmStage::kReturned: return idl::STAGE_RETURNED;
  }
  std::abort();
}

std::optional<AlarmStage> from_idl(idl::AlarmStage value) {
  switch (value) {
    case idl::STAGE_CLEAR: return AlarmStage::kClear;
    case idl::STAGE_UNACKNOWLEDGED: return AlarmStage::kUnacknowledged;
    case idl::STAGE_ACKNOWLEDGED: return AlarmStage::kAcknowledged;
    case idl::STAGE_RETURNED: return AlarmStage::kReturned;
  }
  return std::nullopt;
}

idl::AlarmActionKind to_idl(AlarmActionKind value) {
  switch (value) {
    case AlarmActionKind::kAcknowledge: return idl::ACTION_ACKNOWLEDGE;
    case AlarmActionKind::kShelve: return idl::ACTION_SHELVE;
    case AlarmActionKind::kUnshelve: return idl::ACTION_UNSHELVE;
    case AlarmActionKind::kMaintenance: return idl::ACTION_MAINTENANCE;
    case AlarmActionKind::kEndMaintenance: return idl::ACTION_END_MAINTENANCE;
  }
  std::abort();
}

std::optional<AlarmActionKind> from_idl(idl::AlarmActionKind value) {
  switch (value) {
    case idl::ACTION_ACKNOWLEDGE: return AlarmActionKind::kAcknowledge;
    case idl::ACTION_SHELVE: return AlarmActionKind::kShelve;
    case idl::ACTION_UNSHELVE: return AlarmActionKind::kUnshelve;
    case idl::ACTION_MAINTENANCE: return AlarmActionKind::kMaintenance;
    case idl::ACTION_END_MAINTENANCE: return AlarmActionKind::kEndMaintenance;
  }
  return std::nullopt;
}

idl::SessionState to_idl(ProgramSessionState value) {
  switch (value) {
    case ProgramSessionState::kOpen: return idl::SESSION_OPEN;
    case ProgramSessionState::kClosed: return idl::SESSION_CLOSED;
    case ProgramSessionState::kRefused: return idl::SESSION_REFUSED;
  }
  std::abort();
}

std::optional<ProgramSessionState> from_idl(idl::SessionState value) {
  switch (value) {
    case idl::SESSION_OPEN: return ProgramSessionState::kOpen;
    case idl::SESSION_CLOSED: return ProgramSessionState::kClosed;
    case idl::SESSION_REFUSED: return ProgramSessionState::kRefused;
  }
  return std::nullopt;
}

idl::StandbyNoteKind to_idl(StandbyNoteKind value) {
  switch (value) {
    case StandbyNoteKind::kBegun: return idl::NOTE_BEGUN;
    case StandbyNoteKind::kReturned: return idl::NOTE_RETURNED;
    case StandbyNoteKind::kAnswered: return idl::NOTE_ANSWERED;
  }
  std::abort();
}

std::optional<StandbyNoteKind> from_idl(idl::StandbyNoteKind value) {
  switch (value) {
    case idl::NOTE_BEGUN: return StandbyNoteKind::kBegun;
    case idl::NOTE_RETURNED: return StandbyNoteKind::kReturned;
    case idl::NOTE_ANSWERED: return StandbyNoteKind::kAnswered;
  }
  return std::nullopt;
}

}  // namespace fieldcast
