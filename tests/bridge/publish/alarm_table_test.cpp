#include "bridge/publish/alarm_table.hpp"

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
  std::vector<std::string> take() { return std::exchange(records, {}); }
  std::vector<std::string> records;
};

AlarmRecord alarm(const std::string& bus, const std::string& state, std::int64_t since) {
  return {bus, "plc", "level", "high", state, 95, UtcTime{since}};
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

TEST(AlarmTable, KeepsEachBeginningOnceAndEachEndOnce) {
  RecordingStore store;
  AlarmTable table;
  (void)table.configure(buses({"a"}), kNow);
  table.expect_store();
  table.loaded(store, {});
  table.note(alarm("a", "active", 10));
  table.note(alarm("a", "active", 20));  // its bus started anew
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
  table.loaded(store, {alarm("a", "active", 10)});
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
  EXPECT_EQ(table.configure(wanted, kNow).size(), 2u);  // b is no bus any more
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
  table.loaded(store, {alarm("a", "active", 10), alarm("of another bridge", "active", 20)});
  ASSERT_EQ(store.records.size(), 1u);
  EXPECT_THAT(store.records[0], testing::StartsWith("a/level high clear "));
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

}  // namespace
}  // namespace fieldcast
