#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "bridge/store/alarm_life_table.hpp"
#include "bridge/store/event_table.hpp"
#include "bridge/store/sql/sql.hpp"
#include "tests/bridge/support/bridge_fixture.hpp"
#include "tests/bridge/support/modbus_device.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;

struct BridgeAlarms : BridgeTest {
  BridgeAlarms() {
    folder = std::filesystem::path(testing::TempDir()) /
             ("people-" + std::to_string(::getpid()) +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    spec.store = StoreSpec{folder / "plant.db"};
    for (BusSpec& bus : spec.buses) bus.devices[0].channels[2].limits.high = 1;  // its value is 2
    station.subscribe_alarm_status(
        [this](const StationAlarmStatus& known) { status_of(known.alarm.bus).add(known.status); },
        [this](const StationAlarmStatus& last) { gone.add(last); });
  }
  ~BridgeAlarms() override { std::filesystem::remove_all(folder); }

  static AlarmAction action(AlarmActionKind kind, const std::string& bus) {
    AlarmAction made;
    made.kind = kind;
    made.alarm = {bus, "plc", is_of_device(kind) ? "" : "r2", LimitKind::kHigh};
    made.by = "anna";
    made.note = "on my way";
    if (kind == AlarmActionKind::kShelve || kind == AlarmActionKind::kMaintenance)
      made.duration = hours{1};
    return made;
  }
  [[nodiscard]] bool becomes(const std::string& bus,
                             const std::function<bool(const AlarmStatus&)>& wanted) {
    return status_of(bus).newest(wanted);
  }
  [[nodiscard]] bool becomes(const std::string& bus, AlarmStage stage) {
    return becomes(bus, [stage](const AlarmStatus& known) { return known.stage == stage; });
  }
  std::string done(const AlarmAction& wanted) { return to_text(station.execute(wanted)); }

  std::filesystem::path folder;
  Reports<AlarmStatus>& status_of(const std::string& bus) { return bus == "one" ? one : two; }
  Reports<AlarmStatus> one, two;
  Reports<StationAlarmStatus> gone;
  Station station{spec.dds, "operator"};
};

TEST_F(BridgeAlarms, UserActionsOutliveTheBridge) {
  ModbusDevice a(first), b(second);
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(becomes("one", AlarmStage::kUnacknowledged));
    EXPECT_EQ(one.last().priority, AlarmPriority::kMedium);
    EXPECT_EQ(done(action(AlarmActionKind::kAcknowledge, "one")), "done");
    ASSERT_TRUE(becomes("one", AlarmStage::kAcknowledged));
    EXPECT_EQ(one.last().acknowledged.by, "anna");
    EXPECT_EQ(done(action(AlarmActionKind::kAcknowledge, "one")),
              "rejected: it is acknowledged already, by anna (WRONG_STATE)");
    EXPECT_EQ(done(action(AlarmActionKind::kShelve, "two")), "done");
    ASSERT_TRUE(becomes("two", [](const AlarmStatus& known) { return known.shelved.is_set(); }));
    EXPECT_EQ(done(action(AlarmActionKind::kMaintenance, "two")), "done");
    ASSERT_TRUE(becomes("two", [](const AlarmStatus& known) { return known.suppressed.is_set(); }));
  }
  EXPECT_TRUE(gone.newest([](const StationAlarmStatus&) { return true; }));
  one.forget();
  two.forget();
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(becomes("one", AlarmStage::kAcknowledged));
    EXPECT_EQ(one.last().acknowledged.note, "on my way");
    EXPECT_TRUE(one.last().active);
    one.forget();
    two.forget();
    spec.buses[1].devices[0].channels[0].refresh = milliseconds{120};  // the bus restarts
    ASSERT_TRUE(bridge.reload(spec));
    ASSERT_TRUE(becomes("two", [](const AlarmStatus& known) {
      return known.shelved.is_set() && known.suppressed.is_set() && known.active;
    }));
    EXPECT_EQ(two.last().shelved.by, "anna");
    EXPECT_EQ(done(action(AlarmActionKind::kEndMaintenance, "two")), "done");
    EXPECT_EQ(done(action(AlarmActionKind::kUnshelve, "two")), "done");
    ASSERT_TRUE(becomes("two", [](const AlarmStatus& known) {
      return known.stage == AlarmStage::kUnacknowledged && !known.shelved.is_set() &&
             !known.suppressed.is_set();
    }));
    one.forget();
    two.forget();
    spec.buses[0].devices[0].channels[2].limits.high.reset();
    gone.forget();
    ASSERT_TRUE(bridge.reload(spec));
    EXPECT_TRUE(gone.newest([](const StationAlarmStatus& last) { return last.alarm.bus == "one"; }))
        << "a limit that is taken away has no alarm";
    ASSERT_TRUE(becomes("one", AlarmStage::kClear)) << "its end is published";
    EXPECT_FALSE(one.last().active);
    EXPECT_NE(one.last().cleared_at.nanoseconds, 0);
  }
  const auto connection = open_store(StoreAddress(spec.store->address), IfMissing::kFail);
  std::vector<std::string> log, audit;
  AlarmLifeTable(*connection).log({}, {INT64_MAX}, [&](const AlarmLogEntry& entry) {
    if (entry.bus == "two") log.push_back(entry.event + (entry.who.empty() ? "" : " by anna"));
    return true;
  });
  EXPECT_THAT(log, testing::ElementsAre("raised", "shelved by anna", "maintenance by anna",
                                        "maintenance ended by anna", "unshelved by anna"));
  EventTable(*connection).audit({}, {INT64_MAX}, [&](const AuditEntry& entry) {
    audit.push_back(entry.target + ' ' + entry.what + ": " + entry.result);
    return true;
  });
  EXPECT_THAT(
      audit,
      testing::ElementsAre(
          "one/plc/r2 acknowledge high: on my way: done",
          "one/plc/r2 acknowledge high: on my way: rejected: it is acknowledged already, "
          "by anna",
          "two/plc/r2 shelve high for 1h: on my way: done",
          "two/plc maintenance for 1h: on my way: done", "two/plc end maintenance: on my way: done",
          "two/plc/r2 unshelve high: on my way: done"));
}

TEST_F(BridgeAlarms, ABridgeThatTakesOverContinuesWithTheUserActions) {
  ModbusDevice a(first), b(second);
  Bridge serving, waiting;
  ASSERT_TRUE(serving.start(spec));
  ASSERT_TRUE(becomes("one", AlarmStage::kUnacknowledged));
  BridgeSpec other = spec;
  other.name = "other";
  ASSERT_TRUE(waiting.start(other));  // it has read the store
  EXPECT_EQ(done(action(AlarmActionKind::kAcknowledge, "one")), "done");
  ASSERT_TRUE(becomes("one", AlarmStage::kAcknowledged));
  const auto stored = [&] {
    const auto connection = open_store(StoreAddress(spec.store->address), IfMissing::kFail);
    const KeptAlarms kept = AlarmLifeTable(*connection).kept({});
    return std::any_of(kept.states.begin(), kept.states.end(), [](const KeptAlarm& each) {
      return each.status.stage == AlarmStage::kAcknowledged;
    });
  };
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{15};
  while (!stored() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  one.forget();
  serving.stop();
  ASSERT_TRUE(becomes("one", AlarmStage::kAcknowledged));
  EXPECT_EQ(one.last().acknowledged.by, "anna");
}

TEST_F(BridgeAlarms, ShelvingEndsByItselfWithoutAStoreToo) {
  spec.store.reset();
  ModbusDevice a(first), b(second);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(becomes("one", AlarmStage::kUnacknowledged));
  AlarmAction shelve = action(AlarmActionKind::kShelve, "one");
  shelve.duration = milliseconds{1500};
  EXPECT_EQ(done(shelve), "done");
  ASSERT_TRUE(becomes("one", [](const AlarmStatus& known) { return known.shelved.is_set(); }));
  ASSERT_TRUE(becomes("one", [](const AlarmStatus& known) { return !known.shelved.is_set(); }));
  EXPECT_EQ(one.last().stage, AlarmStage::kUnacknowledged);
}

TEST_F(BridgeAlarms, WhatCannotBeIsRefusedWithItsReason) {
  spec.store.reset();
  ModbusDevice a(first), b(second);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(becomes("one", AlarmStage::kUnacknowledged));
  AlarmAction wrong = action(AlarmActionKind::kAcknowledge, "one");
  wrong.alarm.channel = "r1";
  EXPECT_EQ(done(wrong), "rejected: there is no such limit: one/plc/r1 high (UNKNOWN_CHANNEL)");
  wrong = action(AlarmActionKind::kShelve, "one");
  wrong.duration = hours{25};
  EXPECT_EQ(done(wrong), "rejected: an alarm is shelved for up to 24 hours (RANGE)");
  wrong.duration = minutes{-5};
  EXPECT_EQ(done(wrong), "rejected: an alarm is shelved for up to 24 hours (RANGE)");
  wrong = action(AlarmActionKind::kAcknowledge, "one");
  wrong.by.clear();
  EXPECT_EQ(done(wrong), "rejected: it must say who does it (RANGE)");
  wrong = action(AlarmActionKind::kAcknowledge, "one");
  wrong.raised_at = {1};
  EXPECT_EQ(done(wrong), "rejected: the alarm was raised again since then (WRONG_STATE)");
}

}  // namespace
}  // namespace fieldcast::test
