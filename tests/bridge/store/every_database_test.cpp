#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <future>
#include <limits>

#include "bridge/store/alarm_life_table.hpp"
#include "bridge/store/event_table.hpp"
#include "bridge/store/retention.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/refused_rows.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;

void keeps_every_kind_of_value(const StoreAddress& address) {
  const std::vector<Value> values{true,
                                  std::int64_t{-3},
                                  std::int64_t{INT64_MIN},
                                  std::uint64_t{UINT64_MAX},
                                  0.1,
                                  -std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::denorm_min(),
                                  std::string("it's 20 °C; drop table samples"),
                                  std::string()};
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("kinds", {"c"}));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto second = static_cast<std::int64_t>(i);
      const Sample one[] = {sample(0, values[i], second, i + 1)};
      intake->put(one, kClock, utc(second));
    }
    const Sample not_a_number[] = {sample(0, std::nan(""), 100, 99)};
    intake->put(not_a_number, kClock, utc(100));
    ASSERT_TRUE(store.flush(seconds{30}));
    EXPECT_EQ(store.counters().stored, values.size() + 1);
    EXPECT_EQ(store.counters().dropped, 0u);
  }
  const auto found = history(address, "kinds/d/c");
  ASSERT_EQ(found.size(), values.size() + 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(found[i].value, values[i]) << to_text(values[i]);
    EXPECT_EQ(found[i].sequence, i + 1);
    EXPECT_EQ(found[i].acquired_at, utc(static_cast<std::int64_t>(i)));
    EXPECT_EQ(found[i].unit, "°C");
    EXPECT_EQ(found[i].type, "float32");
  }
  EXPECT_TRUE(std::isnan(std::get<double>(found.back().value)));
}

void keeps_quality_and_both_times(const StoreAddress& address) {
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("stale", {"c"}));
    Sample stale = sample(0, 5.0, 1, 2);
    stale.quality = Quality::kBadDeviceError;
    stale.device_code = 6;
    Sample never;
    const Sample both[] = {stale, never};
    intake->put(both, kClock, utc(9));
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto found = history(address, "stale");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].acquired_at, UtcTime{}) << "by sequence within one instant";
  EXPECT_EQ(found[0].quality, Quality::kNotYetRead);
  EXPECT_EQ(found[1].acquired_at, utc(1));
  EXPECT_EQ(found[1].published_at, utc(9));
  EXPECT_EQ(found[1].quality, Quality::kBadDeviceError);
  EXPECT_EQ(found[1].device_code, 6);
}

void answers_for_a_pattern_and_a_time(const StoreAddress& address) {
  {
    Store store(forever(address));
    const auto one = store.intake(bus_of("many-1", {"b", "a"}));
    const auto other = store.intake(bus_of("many-2", {"a"}));
    for (int second = 0; second < 10; ++second) {
      const auto sequence = static_cast<std::uint64_t>(second);
      const Sample two[] = {sample(0, 1.0, second, sequence), sample(1, 2.0, second, sequence)};
      one->put(two, kClock, utc(second));
      other->put(std::span(two, 1), kClock, utc(second));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  EXPECT_EQ(history(address, "many-*").size(), 30u);
  EXPECT_EQ(history(address, "many-1").size(), 20u);
  const auto some = history(address, "many-*/d/a", utc(3), utc(5));
  std::vector<std::string> seen;
  for (const auto& stored : some) seen.push_back(stored.bus + std::to_string(stored.sequence));
  EXPECT_THAT(seen, ElementsAre("many-13", "many-14", "many-23", "many-24"));
}

void keeps_only_what_the_patterns_name(const StoreAddress& address) {
  StoreSpec spec = forever(address);
  spec.samples = {"chosen/*/a*", "nothing/x"};
  {
    Store store(spec);
    const auto intake = store.intake(bus_of("chosen", {"a1", "b1", "a2"}));
    const Sample all[] = {sample(0, 1.0, 0), sample(1, 2.0, 0), sample(2, 3.0, 0)};
    intake->put(all, kClock, utc(0));
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto found = history(address, "chosen");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].channel, "a1");
  EXPECT_EQ(found[1].channel, "a2");
}

void keeps_audit_alarms_and_devices(const StoreAddress& address) {
  const AuditEntry entry{utc(1), "ann from 10.0.0.1", "program", "bus/d", 1ull << 40, 7, "done"};
  const AlarmRecord raised{"bus", "d", "c", "high", "active", 91.5, utc(2)};
  const DeviceRecord before{"bus", "d", "modbus-rtu", "/dev/ttyS0, 1", "unknown", utc(1)};
  DeviceRecord after = before;
  after.state = "online";
  after.since = utc(3);
  {
    Store store(forever(address));
    store.append(entry);
    store.append({.who = "now"});
    store.put(raised);
    store.put(before);
    store.put(after);
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  EventTable events(*connection);
  std::vector<AuditEntry> audit;
  events.audit({}, kEnd, [&](const AuditEntry& found) {
    audit.push_back(found);
    return true;
  });
  ASSERT_EQ(audit.size(), 2u);
  EXPECT_EQ(audit[0], entry);
  EXPECT_GT(audit[1].at, entry.at) << "an entry without a time gets the present one";
  std::vector<AlarmRecord> alarms;
  events.alarms(utc(2), utc(3), [&](const AlarmRecord& found) {
    alarms.push_back(found);
    return true;
  });
  EXPECT_THAT(alarms, ElementsAre(raised));
  EXPECT_THAT(events.devices(), ElementsAre(after));
}

// Before the first insert, a store reports the active alarms to the next bridge.
void tells_which_alarms_are_active(const StoreAddress& address) {
  AlarmRecord ended{"a", "d", "c", "low", "active", 1.5, utc(2)};
  AlarmRecord again{"a", "d", "c", "high", "active", 91.5, utc(3)};
  const auto active = [&] {
    std::promise<std::vector<KeptAlarm>> told;
    auto answer = told.get_future();
    Store store(forever(address), [&](Store&, const auto& kept) { told.set_value(kept.active); });
    store.put(ended);
    store.put(again);
    EXPECT_EQ(answer.wait_for(seconds{30}), std::future_status::ready);
    return answer.get();
  };
  (void)active();
  ended.state = "clear";
  again.since = utc(5);
  EXPECT_EQ(active().size(), 2u + 1u) << "and the one of the test before";
  std::vector<KeptAlarm> left = active();
  std::erase_if(left, [](const KeptAlarm& alarm) { return alarm.alarm.bus != "a"; });
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(to_text(left[0].alarm), "a/d/c high");
  EXPECT_EQ(left[0].status.value, 91.5);
  EXPECT_EQ(left[0].status.raised_at, utc(5));
}

KeptAlarms kept_in(const StoreAddress& address, UtcTime now) {
  const auto connection = open_store(address, IfMissing::kFail);
  return AlarmLifeTable(*connection).kept(now);
}

void keeps_what_people_did_about_alarms(const StoreAddress& address) {
  const AlarmKey high{"people", "d", "c", LimitKind::kHigh},
      low{"people", "d", "c", LimitKind::kLow};
  KeptAlarm acknowledged{high, {}};
  acknowledged.status.stage = AlarmStage::kAcknowledged;
  acknowledged.status.active = true;
  acknowledged.status.value = 91.5;
  acknowledged.status.raised_at = utc(2);
  acknowledged.status.acknowledged = {"anna", "it's 20 °C; drop table alarms", utc(3)};
  KeptAlarm shelved{low, {}};
  shelved.status.cleared_at = utc(1);
  shelved.status.shelved = {"bert", "noise", utc(4), utc(100)};
  const KeptMaintenance maintenance{{"people", "d"}, {"chen", "inspection", utc(5), utc(200)}};
  {
    Store store(forever(address));
    store.put(AlarmRecord{"people", "d", "c", "high", "active", 91.5, utc(2)});
    store.put(acknowledged);
    store.put(AlarmEvent{utc(3), high, AlarmEventKind::kAcknowledged, "anna", "seen", {}});
    store.put(shelved);
    store.put(maintenance);
    store.put(AlarmEvent{
        utc(5), {"people", "d", {}, {}}, AlarmEventKind::kMaintenance, "chen", "", utc(200)});
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const KeptAlarms kept = kept_in(address, utc(60));
  ASSERT_EQ(kept.states.size(), 2u);
  for (const KeptAlarm& each : kept.states)
    EXPECT_EQ(each.status, each.alarm == high ? acknowledged.status : shelved.status);
  ASSERT_EQ(kept.maintenance.size(), 1u);
  EXPECT_EQ(kept.maintenance[0].device, maintenance.device);
  EXPECT_EQ(kept.maintenance[0].pause, maintenance.pause);
  const std::pair<AlarmKey, UtcTime> occurrence{high, utc(2)};
  EXPECT_THAT(kept.occurrences, testing::Contains(occurrence));
  EXPECT_THAT(kept_in(address, utc(700)).occurrences, testing::Not(testing::Contains(occurrence)));
  {
    const auto connection = open_store(address, IfMissing::kFail);
    std::vector<std::string> log;
    AlarmLifeTable(*connection).log(utc(0), kEnd, [&](const AlarmLogEntry& entry) {
      if (entry.bus == "people")
        log.push_back(entry.event + ' ' + entry.limit + ' ' + entry.who + ' ' +
                      (entry.value ? "91.5" : "-") + ' ' +
                      std::to_string((entry.until.nanoseconds - utc(0).nanoseconds) > 0));
      return true;
    });
    EXPECT_THAT(log, ElementsAre("raised high  91.5 0", "acknowledged high anna - 0",
                                 "maintenance  chen - 1"));
  }
  acknowledged.status = {};
  shelved.status.shelved = {};
  Store store(forever(address));
  store.put(acknowledged);
  store.put(shelved);
  store.put(KeptMaintenance{maintenance.device, {}});
  ASSERT_TRUE(store.flush(seconds{30}));
  EXPECT_TRUE(kept_in(address, utc(60)).states.empty());
  EXPECT_TRUE(kept_in(address, utc(60)).maintenance.empty());
}

// A store of version 5 only has beginnings and ends.
void goes_on_from_version_5(const StoreAddress& address) {
  {
    const auto connection = open_store(address, IfMissing::kFail);
    EventTable(*connection)
        .insert(AlarmRecord{"five", "d", "c", "high-high", "active", 99, utc(7)});
    back_to_version(*connection, 5);
    EXPECT_THROW(connection->script("select 1 from alarm_states"), StoreError);
  }
  const KeptAlarms kept = kept_in(address, utc(60));
  EXPECT_TRUE(kept.states.empty());
  const auto found = std::find_if(kept.active.begin(), kept.active.end(),
                                  [](const auto& each) { return each.alarm.bus == "five"; });
  ASSERT_NE(found, kept.active.end());
  EXPECT_EQ(found->status.raised_at, utc(7));
}

void knows_its_users(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kFail);
  UserTable users(*connection);
  EXPECT_TRUE(users.add("ann", Role::kOperator, "correct horse", utc(0)));
  EXPECT_FALSE(users.add("ann", Role::kViewer, "correct horse", utc(0)));
  const auto verified = users.verify("ann", "correct horse");
  ASSERT_TRUE(verified);
  EXPECT_EQ(verified->role, Role::kOperator);
  EXPECT_EQ(verified->created_at, utc(0));
  EXPECT_FALSE(users.verify("ann", "wrong horse"));
  EXPECT_TRUE(users.remove("ann"));
}

void removes_what_is_too_old(const StoreAddress& address) {
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("old", {"a", "b"}));
    for (int second = 0; second < 100; ++second) {
      const Sample two[] = {sample(0, 1.0, second, 1), sample(1, 1.0, second, 1)};
      intake->put(two, kClock, utc(second));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  StoreSpec spec;
  spec.keep = seconds{10};
  Retention retention(spec);
  const auto connection = open_store(address, IfMissing::kFail);
  write_tiers(*connection);
  int steps = 0;
  while (retention.step(*connection, instant(0), utc(100))) ASSERT_LT(++steps, 1000);
  const auto left = history(address, "old");
  EXPECT_EQ(left.size(), 20u);
  for (const auto& stored : left) EXPECT_GE(stored.published_at, utc(90));
  EXPECT_FALSE(retention.step(*connection, instant(1), utc(200))) << "not before the next pass";
  EXPECT_TRUE(retention.step(*connection, instant(60), utc(200)));
}

// Regression: a clock that was in the year 2097 for a moment removed all samples.
void keeps_what_is_old_by_a_wrong_clock_only(const StoreAddress& address) {
  constexpr std::int64_t kHour = 3600, kToday = 100'000'000, kWrong = kToday + 70 * 8766 * kHour;
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("wrong", {"a"}));
    for (int hour = 0; hour < 48; ++hour) {
      const Sample one[] = {sample(0, 1.0, hour, 1)};
      intake->put(one, kClock, utc(kToday - kHour * hour));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  connection->script("update retention_clock set at = 0");  // the clock of this machine
  TierWriter tiers;
  while (tiers.step(*connection, utc(kToday + kHour))) {}
  StoreSpec spec;
  spec.keep = seconds{47 * kHour + kHour / 2};
  const auto left_after = [&](Retention& retention, std::int64_t second, std::int64_t at) {
    while (retention.step(*connection, instant(second), utc(at))) {}
    return history(address, "wrong").size();
  };
  for (const std::int64_t started_at : {kToday, kWrong}) {
    Retention retention(spec);
    EXPECT_EQ(left_after(retention, 0, started_at), 48u);
    EXPECT_EQ(left_after(retention, 30, kWrong), 48u);
  }
  Retention retention(spec);
  EXPECT_EQ(left_after(retention, 0, kToday), 48u);
  EXPECT_EQ(left_after(retention, kHour, kWrong), 24u) << "it follows by 24 hours in an hour";
  EXPECT_EQ(left_after(retention, 2 * kHour, kToday + 2 * kHour), 24u);
}

void all_of_it(const StoreAddress& address) {
  (void)open_store(address, IfMissing::kCreate);
  const std::pair<const char*, void (*)(const StoreAddress&)> all[] = {
      {"values", keeps_every_kind_of_value},
      {"times", keeps_quality_and_both_times},
      {"pattern", answers_for_a_pattern_and_a_time},
      {"chosen", keeps_only_what_the_patterns_name},
      {"events", keeps_audit_alarms_and_devices},
      {"active alarms", tells_which_alarms_are_active},
      {"what people did", keeps_what_people_did_about_alarms},
      {"version 5", goes_on_from_version_5},
      {"refused events", puts_refused_events_aside},
      {"refused samples", puts_refused_samples_aside},
      {"not a number", goes_on_after_an_alarm_without_a_number},
      {"extremes", goes_on_after_every_extreme},
      {"users", knows_its_users},
      {"retention", removes_what_is_too_old},
      {"wrong-clock", keeps_what_is_old_by_a_wrong_clock_only}};
  for (const auto& [name, check] : all) {
    SCOPED_TRACE(name);
    check(address);
  }
}

TEST(SqliteStore, KeepsValuesEventsUsersAndLetsOldSamplesGo) {
  const Scratch scratch;
  all_of_it(StoreAddress(scratch.path("store.db")));
}

TEST(PostgresStore, DoesAllThatSqliteDoesAndComesBackAfterItsServerDied) {
  fieldcast::test::with_postgres([](fieldcast::test::PostgresServer& server) {
    all_of_it(server.address());
    const auto connection = open_store(server.address(), IfMissing::kFail);
    const std::string odd = std::string("zero\0 in it", 11) + "\xff\xc3\xed\xa0\x80 \xe2\x82\xac";
    connection->query("select $1::text", {odd}, [](const SqlRow& row) {
      EXPECT_EQ(text_at(row, 0), "zero? in it????? \xe2\x82\xac")
          << "what the server does not take";
      return true;
    });
    EXPECT_THROW(connection->script("select no_such_column"), StoreError);
    EXPECT_NO_THROW(connection->script("select 1"))
        << "a refused statement leaves the connection as it was";
    server.stop(SIGQUIT);
    EXPECT_THROW(connection->script("select 1"), StoreError);
    EXPECT_THROW((void)open_store(server.address(), IfMissing::kFail), StoreError);
  });
}

}  // namespace
}  // namespace fieldcast::test
