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
      {Quality::kGood, idl::GOOD, 0},
      {Quality::kUncertain, idl::UNCERTAIN, 1},
      {Quality::kBadNoAnswer, idl::BAD_NO_ANSWER, 2},
      {Quality::kBadFrame, idl::BAD_FRAME, 3},
      {Quality::kBadDeviceError, idl::BAD_DEVICE_ERROR, 4},
      {Quality::kBadRange, idl::BAD_RANGE, 5},
      {Quality::kBadConfiguration, idl::BAD_CONFIGURATION, 6},
      {Quality::kNotYetRead, idl::NOT_YET_READ, 7},
  };
  expect_all(kRows);
}

TEST(EnumConversion, ValueType) {
  constexpr Row<ValueType, idl::ValueType> kRows[] = {
      {ValueType::kBool, idl::TYPE_BOOL, 0},       {ValueType::kInt16, idl::TYPE_INT16, 1},
      {ValueType::kUint16, idl::TYPE_UINT16, 2},   {ValueType::kInt32, idl::TYPE_INT32, 3},
      {ValueType::kUint32, idl::TYPE_UINT32, 4},   {ValueType::kInt64, idl::TYPE_INT64, 5},
      {ValueType::kUint64, idl::TYPE_UINT64, 6},   {ValueType::kFloat32, idl::TYPE_FLOAT32, 7},
      {ValueType::kFloat64, idl::TYPE_FLOAT64, 8}, {ValueType::kBcd16, idl::TYPE_BCD16, 9},
      {ValueType::kBcd32, idl::TYPE_BCD32, 10},    {ValueType::kString, idl::TYPE_STRING, 11},
      {ValueType::kInt8, idl::TYPE_INT8, 12},      {ValueType::kUint8, idl::TYPE_UINT8, 13},
      {ValueType::kBcd8, idl::TYPE_BCD8, 14},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Access) {
  constexpr Row<Access, idl::Access> kRows[] = {
      {Access::kReadOnly, idl::READ_ONLY, 0},
      {Access::kReadWrite, idl::READ_WRITE, 1},
      {Access::kWriteOnly, idl::WRITE_ONLY, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Mode) {
  constexpr Row<Mode, idl::Mode> kRows[] = {
      {Mode::kIntensive, idl::INTENSIVE, 0},
      {Mode::kScheduled, idl::SCHEDULED, 1},
      {Mode::kOnDemand, idl::ON_DEMAND, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, Operation) {
  constexpr Row<Operation, idl::Operation> kRows[] = {
      {Operation::kWrite, idl::OPERATION_WRITE, 0},
      {Operation::kAcquire, idl::OPERATION_ACQUIRE, 1},
  };
  expect_all(kRows);
}

TEST(EnumConversion, CommandState) {
  constexpr Row<CommandState, idl::CommandState> kRows[] = {
      {CommandState::kDone, idl::DONE, 0},         {CommandState::kVerified, idl::VERIFIED, 1},
      {CommandState::kRejected, idl::REJECTED, 2}, {CommandState::kFailed, idl::FAILED, 3},
      {CommandState::kExpired, idl::EXPIRED, 4},
  };
  expect_all(kRows);
}

TEST(EnumConversion, BusState) {
  constexpr Row<BusState, idl::BusState> kRows[] = {
      {BusState::kOpening, idl::BUS_OPENING, 0}, {BusState::kRunning, idl::BUS_RUNNING, 1},
      {BusState::kClosed, idl::BUS_CLOSED, 2},   {BusState::kLeased, idl::BUS_LEASED, 3},
      {BusState::kStopped, idl::BUS_STOPPED, 4},
  };
  expect_all(kRows);
}

TEST(EnumConversion, DeviceState) {
  constexpr Row<DeviceState, idl::DeviceState> kRows[] = {
      {DeviceState::kUnknown, idl::DEVICE_UNKNOWN, 0},
      {DeviceState::kOnline, idl::DEVICE_ONLINE, 1},
      {DeviceState::kDegraded, idl::DEVICE_DEGRADED, 2},
      {DeviceState::kOffline, idl::DEVICE_OFFLINE, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmState) {
  constexpr Row<AlarmState, idl::AlarmState> kRows[] = {
      {AlarmState::kClear, idl::ALARM_CLEAR, 0},
      {AlarmState::kActive, idl::ALARM_ACTIVE, 1},
  };
  expect_all(kRows);
}

TEST(EnumConversion, LimitKind) {
  constexpr Row<LimitKind, idl::LimitKind> kRows[] = {
      {LimitKind::kLowLow, idl::LIMIT_LOW_LOW, 0},
      {LimitKind::kLow, idl::LIMIT_LOW, 1},
      {LimitKind::kHigh, idl::LIMIT_HIGH, 2},
      {LimitKind::kHighHigh, idl::LIMIT_HIGH_HIGH, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmPriority) {
  constexpr Row<AlarmPriority, idl::AlarmPriority> kRows[] = {
      {AlarmPriority::kLow, idl::PRIORITY_LOW, 0},
      {AlarmPriority::kMedium, idl::PRIORITY_MEDIUM, 1},
      {AlarmPriority::kHigh, idl::PRIORITY_HIGH, 2},
      {AlarmPriority::kCritical, idl::PRIORITY_CRITICAL, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmStage) {
  constexpr Row<AlarmStage, idl::AlarmStage> kRows[] = {
      {AlarmStage::kClear, idl::STAGE_CLEAR, 0},
      {AlarmStage::kUnacknowledged, idl::STAGE_UNACKNOWLEDGED, 1},
      {AlarmStage::kAcknowledged, idl::STAGE_ACKNOWLEDGED, 2},
      {AlarmStage::kReturned, idl::STAGE_RETURNED, 3},
  };
  expect_all(kRows);
}

TEST(EnumConversion, AlarmActionKind) {
  constexpr Row<AlarmActionKind, idl::AlarmActionKind> kRows[] = {
      {AlarmActionKind::kAcknowledge, idl::ACTION_ACKNOWLEDGE, 0},
      {AlarmActionKind::kShelve, idl::ACTION_SHELVE, 1},
      {AlarmActionKind::kUnshelve, idl::ACTION_UNSHELVE, 2},
      {AlarmActionKind::kMaintenance, idl::ACTION_MAINTENANCE, 3},
      {AlarmActionKind::kEndMaintenance, idl::ACTION_END_MAINTENANCE, 4},
  };
  expect_all(kRows);
}

TEST(EnumConversion, StandbyNoteKind) {
  constexpr Row<StandbyNoteKind, idl::StandbyNoteKind> kRows[] = {
      {StandbyNoteKind::kBegun, idl::NOTE_BEGUN, 0},
      {StandbyNoteKind::kReturned, idl::NOTE_RETURNED, 1},
      {StandbyNoteKind::kAnswered, idl::NOTE_ANSWERED, 2},
  };
  expect_all(kRows);
}

TEST(EnumConversion, ProgramSessionState) {
  constexpr Row<ProgramSessionState, idl::SessionState> kRows[] = {
      {ProgramSessionState::kOpen, idl::SESSION_OPEN, 0},
      {ProgramSessionState::kClosed, idl::SESSION_CLOSED, 1},
      {ProgramSessionState::kRefused, idl::SESSION_REFUSED, 2},
  };
  expect_all(kRows);
}

// The conversions use these by name; their numbers are part of the wire format too.
TEST(EnumConversion, NumbersOfWhatHasNoCounterpartInCore) {
  EXPECT_EQ(static_cast<int>(idl::VALUE_BOOLEAN), 0);
  EXPECT_EQ(static_cast<int>(idl::VALUE_INT64), 1);
  EXPECT_EQ(static_cast<int>(idl::VALUE_UINT64), 2);
  EXPECT_EQ(static_cast<int>(idl::VALUE_DOUBLE), 3);
  EXPECT_EQ(static_cast<int>(idl::VALUE_STRING), 4);
  EXPECT_EQ(static_cast<int>(idl::TARGET_CHANNEL), 0);
  EXPECT_EQ(static_cast<int>(idl::TARGET_ADDRESS), 1);
  EXPECT_EQ(static_cast<int>(idl::LIMIT_WRITE_MIN), 4);
  EXPECT_EQ(static_cast<int>(idl::LIMIT_WRITE_MAX), 5);
  EXPECT_EQ(from_idl(idl::LIMIT_WRITE_MIN), std::nullopt);
  EXPECT_EQ(from_idl(idl::LIMIT_WRITE_MAX), std::nullopt);
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
