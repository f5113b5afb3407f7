#include "bridge/dds/topics/conversion_enums.hpp"

#include <gtest/gtest.h>

#include <string>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {
namespace {

// Checks the wire number of every enumerator: other and older stations are compiled with it.

template <typename Core, typename Topic>
struct Row {
  Core core;
  Topic topic;
  int number;  // on the wire
};

template <typename Core, typename Topic, std::size_t Count>
void expect_all(const Row<Core, Topic> (&rows)[Count]) {
  for (std::size_t i = 0; i < Count; ++i) {
    SCOPED_TRACE("row " + std::to_string(i));
    EXPECT_EQ(to_idl(rows[i].core), rows[i].topic);
    EXPECT_EQ(from_idl(rows[i].topic), rows[i].core);
    EXPECT_EQ(static_cast<int>(rows[i].topic), rows[i].number);
    EXPECT_EQ(rows[i].number, static_cast<int>(i));
  }
  EXPECT_EQ(from_idl(static_cast<Topic>(Count)), std::nullopt) << "one that no row names";
  EXPECT_EQ(from_idl(static_cast<Topic>(77)), std::nullopt);
}

TEST(EnumConversion, Quality) {
  constexpr Row<Quality, idl::Quality> kRows[] = {
      {Quality::kGood, idl::Quality::GOOD, 0},
      {Quality::kUncertain, idl::Quality::UNCERTAIN, 1},
      {Quality::kBadNoResponse, idl::Quality::BAD_NO_ANSWER, 2},
      {Quality::kBadFrame, idl::Quality::BAD_FRAME, 3},
      {Quality::kBadDeviceError, idl::Quality::BAD_DEVICE_ERROR, 4},
      {Quality::kBadRange, idl::Quality::BAD_RANGE, 5},
      {Quality::kBadConfiguration, idl::Quality::BAD_CONFIGURATION, 6},
      {Quality::kNotYetRead, idl::Quality::NOT_YET_READ, 7},
  };
  expect_all(kRows);
}

TEST(EnumConversion, ValueType) {
  constexpr Row<ValueType, idl::ValueType> kRows[] = {
      {ValueType::kBool, idl::ValueType::TYPE_BOOL, 0},
      {ValueType::kInt16, idl::ValueType::TYPE_INT16, 1},
      {ValueType::kUint16, idl::ValueType::TYPE_UINT16, 2},
      {ValueType::kInt32, idl::ValueType::TYPE_INT32, 3},
      {ValueType::kUint32, idl::ValueType::TYPE_UINT32, 4},
      {ValueType::kInt64, idl::ValueType::TYPE_INT64, 5},
      {ValueType::kUint64, idl::ValueType::TYPE_UINT64, 6},
      {ValueType::kFloat32, idl::ValueType::TYPE_FLOAT32, 7},
      {ValueType::kFloat64, idl::ValueType::TYPE_FLOAT64, 8},
      {ValueType::kBcd16, idl::ValueType::TYPE_BCD16, 9},
      {ValueType::kBcd32, idl::ValueType::TYPE_BCD32, 10},
      {ValueType::kString, idl::ValueType::TYPE_STRING, 11},
      {ValueType::kInt8, idl::ValueType::TYPE_INT8, 12},
      {ValueType::kUint8, idl::ValueType::TYPE_UINT8, 13},
      {ValueType::kBcd8, idl::ValueType::TYPE_BCD8, 14},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Access) {
  constexpr Row<Access, idl::Access> kRows[] = {
      {Access::kReadOnly, idl::Access::READ_ONLY, 0},
      {Access::kReadWrite, idl::Access::READ_WRITE, 1},
      {Access::kWriteOnly, idl::Access::WRITE_ONLY, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Mode) {
  constexpr Row<Mode, idl::Mode> kRows[] = {
      {Mode::kIntensive, idl::Mode::INTENSIVE, 0},
      {Mode::kScheduled, idl::Mode::SCHEDULED, 1},
      {Mode::kOnDemand, idl::Mode::ON_DEMAND, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Operation) {
  constexpr Row<Operation, idl::Operation> kRows[] = {
      {Operation::kWrite, idl::Operation::OPERATION_WRITE, 0},
      {Operation::kAcquire, idl::Operation::OPERATION_ACQUIRE, 1},
  };
  expect_all(kRows);
}

TEST(EnumConversion, CommandState) {
  constexpr Row<CommandState, idl::CommandState> kRows[] = {
      {CommandState::kDone, idl::CommandState::DONE, 0},
      {CommandState::kVerified, idl::CommandState::VERIFIED, 1},
      {CommandState::kRejected, idl::CommandState::REJECTED, 2},
      {CommandState::kFailed, idl::CommandState::FAILED, 3},
      {CommandState::kExpired, idl::CommandState::EXPIRED, 4},
  };
  expect_all(kRows);
}

TEST(EnumConversion, BusState) {
  constexpr Row<BusState, idl::BusState> kRows[] = {
      {BusState::kOpening, idl::BusState::BUS_OPENING, 0},
      {BusState::kRunning, idl::BusState::BUS_RUNNING, 1},
      {BusState::kClosed, idl::BusState::BUS_CLOSED, 2},
      {BusState::kLeased, idl::BusState::BUS_LEASED, 3},
      {BusState::kStopped, idl::BusState::BUS_STOPPED, 4},
  };
  expect_all(kRows);
}

TEST(EnumConversion, DeviceState) {
  constexpr Row<DeviceState, idl::DeviceState> kRows[] = {
      {DeviceState::kUnknown, idl::DeviceState::DEVICE_UNKNOWN, 0},
      {DeviceState::kOnline, idl::DeviceState::DEVICE_ONLINE, 1},
      {DeviceState::kDegraded, idl::DeviceState::DEVICE_DEGRADED, 2},
      {DeviceState::kOffline, idl::DeviceState::DEVICE_OFFLINE, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmState) {
  constexpr Row<AlarmState, idl::AlarmState> kRows[] = {
      {AlarmState::kClear, idl::AlarmState::ALARM_CLEAR, 0},
      {AlarmState::kActive, idl::AlarmState::ALARM_ACTIVE, 1},
  };
  expect_all(kRows);
}

TEST(EnumConversion, LimitKind) {
  constexpr Row<LimitKind, idl::LimitKind> kRows[] = {
      {LimitKind::kLowLow, idl::LimitKind::LIMIT_LOW_LOW, 0},
      {LimitKind::kLow, idl::LimitKind::LIMIT_LOW, 1},
      {LimitKind::kHigh, idl::LimitKind::LIMIT_HIGH, 2},
      {LimitKind::kHighHigh, idl::LimitKind::LIMIT_HIGH_HIGH, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmPriority) {
  constexpr Row<AlarmPriority, idl::AlarmPriority> kRows[] = {
      {AlarmPriority::kLow, idl::AlarmPriority::PRIORITY_LOW, 0},
      {AlarmPriority::kMedium, idl::AlarmPriority::PRIORITY_MEDIUM, 1},
      {AlarmPriority::kHigh, idl::AlarmPriority::PRIORITY_HIGH, 2},
      {AlarmPriority::kCritical, idl::AlarmPriority::PRIORITY_CRITICAL, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmStage) {
  constexpr Row<AlarmStage, idl::AlarmStage> kRows[] = {
      {AlarmStage::kClear, idl::AlarmStage::STAGE_CLEAR, 0},
      {AlarmStage::kUnacknowledged, idl::AlarmStage::STAGE_UNACKNOWLEDGED, 1},
      {AlarmStage::kAcknowledged, idl::AlarmStage::STAGE_ACKNOWLEDGED, 2},
      {AlarmStage::kReturned, idl::AlarmStage::STAGE_RETURNED, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmActionKind) {
  constexpr Row<AlarmActionKind, idl::AlarmActionKind> kRows[] = {
      {AlarmActionKind::kAcknowledge, idl::AlarmActionKind::ACTION_ACKNOWLEDGE, 0},
      {AlarmActionKind::kShelve, idl::AlarmActionKind::ACTION_SHELVE, 1},
      {AlarmActionKind::kUnshelve, idl::AlarmActionKind::ACTION_UNSHELVE, 2},
      {AlarmActionKind::kMaintenance, idl::AlarmActionKind::ACTION_MAINTENANCE, 3},
      {AlarmActionKind::kEndMaintenance, idl::AlarmActionKind::ACTION_END_MAINTENANCE, 4},
      {AlarmActionKind::kEndSession, idl::AlarmActionKind::ACTION_END_SESSION, 5},
  };
  expect_all(kRows);
}

TEST(EnumConversion, StandbyNoteKind) {
  constexpr Row<StandbyNoteKind, idl::StandbyNoteKind> kRows[] = {
      {StandbyNoteKind::kBegun, idl::StandbyNoteKind::NOTE_BEGUN, 0},
      {StandbyNoteKind::kReturned, idl::StandbyNoteKind::NOTE_RETURNED, 1},
      {StandbyNoteKind::kCompleted, idl::StandbyNoteKind::NOTE_ANSWERED, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, ProgramSessionState) {
  constexpr Row<ProgramSessionState, idl::SessionState> kRows[] = {
      {ProgramSessionState::kOpen, idl::SessionState::SESSION_OPEN, 0},
      {ProgramSessionState::kClosed, idl::SessionState::SESSION_CLOSED, 1},
      {ProgramSessionState::kRefused, idl::SessionState::SESSION_REFUSED, 2},
  };
  expect_all(kRows);
}

// The conversions use these by name; their numbers are part of the wire format too.
TEST(EnumConversion, NumbersOfWhatHasNoCounterpartInCore) {
  EXPECT_EQ(static_cast<int>(idl::ValueKind::VALUE_BOOLEAN), 0);
  EXPECT_EQ(static_cast<int>(idl::ValueKind::VALUE_INT64), 1);
  EXPECT_EQ(static_cast<int>(idl::ValueKind::VALUE_UINT64), 2);
  EXPECT_EQ(static_cast<int>(idl::ValueKind::VALUE_DOUBLE), 3);
  EXPECT_EQ(static_cast<int>(idl::ValueKind::VALUE_STRING), 4);
  EXPECT_EQ(static_cast<int>(idl::TargetKind::TARGET_CHANNEL), 0);
  EXPECT_EQ(static_cast<int>(idl::TargetKind::TARGET_ADDRESS), 1);
  EXPECT_EQ(static_cast<int>(idl::LimitKind::LIMIT_WRITE_MIN), 4);
  EXPECT_EQ(static_cast<int>(idl::LimitKind::LIMIT_WRITE_MAX), 5);
  EXPECT_EQ(from_idl(idl::LimitKind::LIMIT_WRITE_MIN), std::nullopt);
  EXPECT_EQ(from_idl(idl::LimitKind::LIMIT_WRITE_MAX), std::nullopt);
}

TEST(BridgeConversion, BringsEveryFieldThere) {
  const BridgeClaims claims{
      "line-7", "host", "boot/pid:[1]/7/8", {5}, {{"one", {{6}, true}}, {"two", {{7}, false}}}};
  idl::Bridge topic;
  to_idl(claims, topic);
  EXPECT_EQ(from_idl(topic), claims);
  EXPECT_FALSE(std::string(topic.version().c_str()).empty());
}

TEST(BridgeConversion, LeavesOutWhatDoesNotFit) {
  BridgeClaims claims;
  for (int i = 0; i <= kMaxBuses; ++i) claims.buses["bus-" + std::to_string(i)] = {};
  idl::Bridge topic;
  to_idl(claims, topic);
  EXPECT_EQ(topic.buses().size(), static_cast<std::size_t>(kMaxBuses));
  to_idl(BridgeClaims{}, topic);
  EXPECT_TRUE(topic.buses().empty());
}

}  // namespace
}  // namespace fieldcast
