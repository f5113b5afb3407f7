#include "bridge/alarm/alarm_table.hpp"

#include <gmock/gmock.h>

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct RecordingStore final : AlarmSink {
  void put(AlarmRecord alarm) override {
    std::string said = alarm.bus;
    said += '/' + alarm.channel + ' ' + alarm.limit + ' ' + alarm.state + ' ';
    records.push_back(said + std::to_string(alarm.since.nanoseconds));
  }
  void put(KeptAlarm alarm) override {
    kept.push_back(to_text(alarm.alarm) + ' ' + std::string(to_text(alarm.status.stage)));
  }
  void put(KeptMaintenance maintenance) override {
    kept.push_back("maintenance " + maintenance.device.second +
                   (maintenance.pause.is_set() ? "" : " ended"));
  }
  void put(AlarmEvent event) override {
    kept.push_back(to_text(event.alarm) + ' ' + std::string(to_text(event.kind)) + " by " +
                   event.by);
  }
  std::vector<std::string> take() { return std::exchange(records, {}); }
  std::vector<std::string> take_kept() { return std::exchange(kept, {}); }
  std::vector<std::string> records, kept;
};

AlarmRecord alarm(const std::string& bus, const std::string& state, std::int64_t since) {
  return {bus, "plc", "level", "high", state, 95, UtcTime{since}};
}

KeptAlarms active(const std::vector<AlarmRecord>& records) {
  KeptAlarms kept;
  for (const AlarmRecord& record : records) {
    KeptAlarm& alarm = kept.active.emplace_back();
    alarm.alarm = {record.bus, record.device, record.channel, *limit_kind_from(record.limit)};
    alarm.status.value = record.value;
    alarm.status.raised_at = record.since;
  }
  return kept;
}

std::vector<BusSpec> buses(const std::vector<std::string>& names, bool limit = true) {
  std::vector<BusSpec> made;
  for (const std::string& name : names) {
    BusSpec& bus = made.emplace_back();
    bus.name = name;
    ChannelSpec& channel = bus.devices.emplace_back().channels.emplace_back();
    bus.devices[0].name = "plc";
    channel.name = "level";
    if (limit) channel.limits.high = 90;
  }
  return made;
}

constexpr UtcTime kNow{1000};

AlarmAction acknowledge(const std::string& bus) {
  AlarmAction action;
  action.alarm = {bus, "plc", "level", LimitKind::kHigh};
  action.by = "anna";
  return action;
}

TEST(AlarmTable, KeepsEachBeginningOnceAndEachEndOnce) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a"}), kNow);
  table.expect_store();
  table.loaded(store, {});
  table.note(alarm("a", "active", 10));
  table.note(alarm("a", "active", 20));  // its bus restarted
  ASSERT_EQ(table.active_of("a").size(), 1u);
  EXPECT_EQ(table.active_of("a")[0].since.nanoseconds, 10);
  table.note(alarm("a", "clear", 30));
  table.note(alarm("a", "clear", 40));
  EXPECT_THAT(store.take(), ElementsAre("a/level high active 10", "a/level high clear 30"));
  EXPECT_THAT(table.active_of("a"), IsEmpty());
}

TEST(AlarmTable, AnAlarmOfBeforeTheRestartGoesOnWithItsBeginning) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a", "b"}), kNow);
  table.expect_store();
  table.note(alarm("a", "active", 50));  // before the store is open
  table.note(alarm("b", "active", 60));
  const auto before = table.version();
  table.loaded(store, active({alarm("a", "active", 10)}));
  EXPECT_NE(table.version(), before);
  EXPECT_THAT(store.take(), ElementsAre("b/level high active 60"));
  EXPECT_EQ(table.active_of("a").at(0).since.nanoseconds, 10);
  table.note(alarm("a", "clear", 70));
  EXPECT_THAT(store.take(), ElementsAre("a/level high clear 70"));
}

TEST(AlarmTable, AnAlarmWhoseLimitIsTakenAwayEnds) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a", "b", "c"}), kNow);
  table.expect_store();
  table.loaded(store, {});
  for (const char* bus : {"a", "b", "c"}) table.note(alarm(bus, "active", 10));
  (void)store.take();
  auto wanted = buses({"a"}, false);
  wanted.push_back(buses({"c"}).front());
  EXPECT_EQ(table.configure(wanted, kNow).size(), 2u);  // b is no longer a bus
  EXPECT_THAT(store.take(), ElementsAre("a/level high clear 1000", "b/level high clear 1000"));
  table.note(alarm("a", "active", 20));  // the bus has not stopped yet
  EXPECT_THAT(store.take(), IsEmpty());
  EXPECT_THAT(table.active_of("a"), IsEmpty());
}

TEST(AlarmTable, WhatTheConfigurationLostWhileTheBridgeWasDownEndsAndOtherBridgesAreLeftAlone) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a"}, false), kNow);
  table.expect_store();
  table.loaded(store, active({alarm("a", "active", 10), alarm("of another bridge", "active", 20)}));
  ASSERT_EQ(store.records.size(), 1u);
  EXPECT_THAT(store.records[0], testing::StartsWith("a/level high clear "));
  const auto status = table.status_of({"a", "plc", "level", LimitKind::kHigh});
  ASSERT_TRUE(status);
  EXPECT_EQ(status->stage, AlarmStage::kClear);
  EXPECT_EQ(status->raised_at.nanoseconds, 10);
  EXPECT_NE(status->cleared_at.nanoseconds, 0);
  EXPECT_FALSE(table.status_of({"of another bridge", "plc", "level", LimitKind::kHigh}));
}

// Regression: stations learned only that its instance was disposed, as when a bridge stops.
TEST(AlarmTable, TheEndOfAnAlarmWhoseLimitIsRemovedIsPublishedAlsoByARestartedBus) {
  AlarmTable table;
  std::vector<std::string> published;
  table.publish_with([&](const AlarmKey& alarm) {
    const auto status = table.status_of(alarm);
    published.push_back(alarm.bus + ' ' + (status ? std::string(to_text(status->stage)) : "none"));
  });
  const AlarmKey key{"a", "plc", "level", LimitKind::kHigh};
  (void)table.configure(buses({"a", "b"}), kNow);
  table.note(alarm("a", "active", 10));
  table.note(alarm("b", "active", 10));
  table.note(alarm("b", "clear", 20));
  AlarmAction shelve = acknowledge("a");
  shelve.kind = AlarmActionKind::kShelve;
  shelve.duration = std::chrono::minutes{30};
  ASSERT_TRUE(table.act(shelve, kNow));
  published.clear();
  (void)table.configure(buses({"a"}, false), {2000});
  EXPECT_THAT(published, ElementsAre("a clear", "b clear")) << "b was not acknowledged";
  const auto status = table.status_of(key);
  ASSERT_TRUE(status);
  EXPECT_TRUE(status->is_normal());
  EXPECT_EQ(status->raised_at.nanoseconds, 10);
  EXPECT_EQ(status->cleared_at.nanoseconds, 2000);
  published.clear();
  table.publish_again("a");
  EXPECT_THAT(published, ElementsAre("a clear"));
  (void)table.configure(buses({"a"}), kNow);
  table.note(alarm("a", "active", 3000));
  EXPECT_EQ(table.status_of(key)->stage, AlarmStage::kUnacknowledged);
  (void)table.configure(buses({"c"}), kNow);
  (void)table.configure(buses({"c"}), kNow);
  EXPECT_FALSE(table.status_of(key)) << "its bus was removed";
}

TEST(AlarmTable, WithoutAStoreAlarmsGoOnOverReloads) {
  AlarmTable table;
  (void)table.configure(buses({"a"}), kNow);
  table.note(alarm("a", "active", 10));
  EXPECT_THAT(table.configure(buses({"a", "b"}), kNow), IsEmpty());
  EXPECT_EQ(table.active_of("a").at(0).since.nanoseconds, 10);
  EXPECT_EQ(table.configure(buses({"b"}), kNow).size(), 1u);
}

TEST(AlarmTable, WhatIsHeldGoesToAStoreThatNeverOpened) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a"}), kNow);
  table.expect_store();
  table.note(alarm("a", "active", 10));
  EXPECT_THAT(store.take(), IsEmpty());
  table.close(&store);
  EXPECT_THAT(store.take(), ElementsAre("a/level high active 10"));
}

TEST(AlarmTable, UserActionsAreKeptAndPublished) {
  RecordingStore store;
  AlarmTable table;
  std::vector<std::string> published;
  table.publish_with([&](const AlarmKey& alarm) {
    const auto status = table.status_of(alarm);
    published.push_back(status ? std::string(to_text(status->stage)) : "none");
  });
  (void)table.configure(buses({"a"}), kNow);
  table.expect_store();
  const auto too_early = table.act(acknowledge("a"), kNow);
  ASSERT_FALSE(too_early);
  EXPECT_EQ(too_early.error().cause, Cause::kOffline);
  table.loaded(store, {});
  table.note(alarm("a", "active", 10));
  EXPECT_TRUE(table.act(acknowledge("a"), kNow));
  EXPECT_FALSE(table.act(acknowledge("a"), kNow));
  table.note(alarm("a", "clear", 20));
  EXPECT_THAT(store.take_kept(),
              ElementsAre("a/plc/level high unacknowledged", "a/plc/level high acknowledged",
                          "a/plc/level high acknowledged by anna", "a/plc/level high clear"));
  EXPECT_THAT(published, ElementsAre("unacknowledged", "acknowledged", "clear"));
  published.clear();
  table.publish_again("b");
  table.publish_again("a");
  (void)table.configure(buses({"a"}, false), kNow);
  EXPECT_THAT(published, ElementsAre("clear", "none"));
  table.publish_with({});
  (void)table.configure(buses({"a"}), kNow);
  table.note(alarm("a", "active", 30));
  EXPECT_EQ(published.size(), 2u);
}

TEST(AlarmTable, ContinuesWithTheUserActionsBeforeTheRestart) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a", "b"}), kNow);
  table.expect_store();
  table.note(alarm("a", "active", 50));  // the samples arrive before the store is open
  KeptAlarms kept = active({alarm("a", "active", 10)});
  kept.states = kept.active;
  kept.states[0].status.stage = AlarmStage::kAcknowledged;
  kept.states[0].status.active = true;
  kept.states[0].status.acknowledged = {"anna", "seen", {20}};
  table.loaded(store, kept);
  const auto status = table.status_of({"a", "plc", "level", LimitKind::kHigh});
  ASSERT_TRUE(status);
  EXPECT_EQ(status->stage, AlarmStage::kAcknowledged);
  EXPECT_EQ(status->acknowledged.by, "anna");
  EXPECT_EQ(status->raised_at.nanoseconds, 10);
  EXPECT_THAT(store.take_kept(), IsEmpty()) << "the store has it";
}

TEST(AlarmTable, TakesOverWhatAnotherBridgeLeftOfOneBus) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a", "b"}), kNow);
  table.expect_store();
  table.loaded("a", active({alarm("a", "active", 1)}));  // too early: the store is not open
  EXPECT_THAT(table.active_of("a"), IsEmpty());
  table.loaded(store, active({alarm("a", "active", 10), alarm("b", "active", 10)}));
  (void)store.take_kept();
  KeptAlarms kept = active({alarm("a", "active", 30), alarm("b", "active", 30)});
  kept.states = kept.active;
  for (KeptAlarm& each : kept.states) {
    each.status.stage = AlarmStage::kAcknowledged;
    each.status.active = true;
  }
  const auto before = table.version();
  table.loaded("a", kept);
  EXPECT_NE(table.version(), before);
  EXPECT_EQ(table.active_of("a").at(0).since.nanoseconds, 30);
  EXPECT_EQ(table.active_of("b").at(0).since.nanoseconds, 10);
  EXPECT_EQ(table.status_of({"a", "plc", "level", LimitKind::kHigh})->stage,
            AlarmStage::kAcknowledged);
  EXPECT_EQ(table.status_of({"b", "plc", "level", LimitKind::kHigh})->stage,
            AlarmStage::kUnacknowledged);
}

TEST(AlarmTable, ShelvingAndMaintenanceEndWithTime) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a"}), kNow);
  table.expect_store();
  table.loaded(store, {});
  AlarmAction action = acknowledge("a");
  action.kind = AlarmActionKind::kShelve;
  action.duration = std::chrono::minutes{30};
  ASSERT_TRUE(table.act(action, kNow));
  action.kind = AlarmActionKind::kMaintenance;
  ASSERT_TRUE(table.act(action, kNow));
  (void)store.take_kept();
  table.on_time("a", {kNow.nanoseconds + action.duration.count() - 1});
  EXPECT_THAT(store.take_kept(), IsEmpty());
  table.on_time("a", {kNow.nanoseconds + action.duration.count()});
  EXPECT_THAT(store.take_kept(),
              testing::UnorderedElementsAre("a/plc/level high clear", "maintenance plc ended",
                                            "a/plc maintenance ended by ",
                                            "a/plc/level high shelving ended by "));
}

}  // namespace
}  // namespace fieldcast
