#include "tests/bridge/store/refused_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "bridge/store/quarantine.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;

std::int64_t number_in(SqlConnection& connection, const std::string& sql) {
  std::int64_t number = -1;
  connection.query(sql, {}, [&](const SqlRow& row) {
    number = integer_at(row, 0);
    return false;
  });
  return number;
}

struct RefusedRow {
  std::string table, reason;
  nlohmann::json content;
};
std::vector<RefusedRow> quarantine_of(SqlConnection& connection) {
  std::vector<RefusedRow> rows;
  connection.query(
      "select table_name, reason, content from quarantine_list order by id", {},
      [&](const SqlRow& row) {
        rows.push_back({text_at(row, 0), text_at(row, 1), nlohmann::json::parse(text_at(row, 2))});
        return true;
      });
  connection.script("delete from quarantine");
  return rows;
}

void refuse_some_samples(SqlConnection& connection) {
  connection.script(connection.dialect() == SqlConnection::Dialect::kSqlite
                        ? "create trigger refuse before insert on samples when "
                          "new.device_code = 666 begin select raise(abort, 'not 666'); end"
                        : "alter table samples add constraint refuse check (device_code <> 666)");
}
void accept_all_samples(SqlConnection& connection) {
  connection.script(connection.dialect() == SqlConnection::Dialect::kSqlite
                        ? "drop trigger refuse"
                        : "alter table samples drop constraint refuse");
}

}  // namespace

// An index of the test represents any reason of a refusal.
void puts_refused_events_aside(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  connection->script("create unique index only_one on alarms (bus) where bus = 'refused'");
  {
    Store store(forever(address));
    store.put(AlarmRecord{"refused", "d", "c", "high", "active", 1, utc(8)});
    store.put(AlarmRecord{"refused", "d", "\xff\u202e", "high", "clear", 1.5, utc(9)});
    store.put(AlarmRecord{"accepted", "d", "c", "high", "active", 1, utc(9)});
    ASSERT_TRUE(store.flush(seconds{30}));
    EXPECT_EQ(store.counters().quarantined, 1u);
  }
  const std::vector<RefusedRow> refused = quarantine_of(*connection);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].table, "alarms");
  EXPECT_NE(refused[0].reason, "");
  EXPECT_EQ(refused[0].content["channel"], "\\xFF\u202e");
  EXPECT_EQ(refused[0].content["value"], 1.5);
  EXPECT_EQ(refused[0].content["since"], utc(9).nanoseconds);
  std::vector<std::string> stored;
  connection->query("select bus from alarms where bus in ('refused', 'accepted') order by id", {},
                    [&](const SqlRow& row) {
                      stored.push_back(text_at(row, 0));
                      return true;
                    });
  EXPECT_THAT(stored, ElementsAre("refused", "accepted"));
  std::vector<SqlRow> many;
  for (std::int64_t i = 0; i < QuarantineTable::kMaxKept + 2; ++i) many.push_back({i});
  connection->execute(
      "insert into quarantine (at, table_name, content, reason) values ($1, '', '{}', '')", many);
  {
    Store store(forever(address));
    store.put(AlarmRecord{"refused", "d", "c", "low", "active", 1, utc(10)});
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  EXPECT_EQ(number_in(*connection, "select count(*) from quarantine"), QuarantineTable::kMaxKept);
  EXPECT_EQ(number_in(*connection, "select min(at) from quarantine"), 3);
  connection->script(
      "drop index only_one; delete from quarantine; "
      "delete from alarms where bus in ('refused', 'accepted')");
}

void puts_refused_samples_aside(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  refuse_some_samples(*connection);
  connection->script("create unique index only_one on channels (unit) where unit = 'once'");
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("aside", {"a", "b"}));
    const auto once =
        store.number_of({.bus = "aside", .device = "d", .channel = "x", .unit = "once"});
    const auto twice =
        store.number_of({.bus = "aside", .device = "d", .channel = "y", .unit = "once"});
    ASSERT_TRUE(once && twice);
    Sample refused = sample(1, std::uint64_t{UINT64_MAX}, 2, 7);
    refused.device_code = 666;
    const Sample some[] = {sample(0, 1.0, 1, 1), sample(1, 2.0, 1, 1), refused,
                           sample(0, 3.0, 2, 2), sample(1, 4.0, 3, 8)};
    intake->put(some, kClock, utc(1));
    const SampleRow rows[] = {
        {.channel = *once, .published_at = utc(1), .sequence = 1, .value = 1.0},
        {.channel = *twice, .published_at = utc(1), .sequence = 1, .value = std::nan("")}};
    store.put(rows);
    store.append({.at = utc(1), .who = "aside"});
    ASSERT_TRUE(store.flush(seconds{30}));
    EXPECT_EQ(store.counters().quarantined, 2u);
    EXPECT_EQ(store.counters().stored, 5u);
    EXPECT_EQ(store.counters().dropped, 0u);
    const Sample next[] = {sample(0, 5.0, 4, 3)};
    intake->put(next, kClock, utc(4));
    ASSERT_TRUE(store.flush(seconds{30}));
    EXPECT_EQ(store.counters().quarantined, 2u);
  }
  const std::vector<RefusedRow> refused = quarantine_of(*connection);
  ASSERT_EQ(refused.size(), 2u);
  EXPECT_EQ(refused[0].table, "samples");
  EXPECT_EQ(refused[0].content["value"], UINT64_MAX);
  EXPECT_EQ(refused[0].content["sequence"], 7);
  EXPECT_EQ(refused[1].content["channel"], "y");
  EXPECT_EQ(refused[1].content["value"], "nan");
  EXPECT_EQ(history(address, "aside/d/a").size(), 3u);
  EXPECT_EQ(history(address, "aside/d/b").size(), 2u);
  EXPECT_EQ(history(address, "aside/d/x").size(), 1u);
  EXPECT_EQ(number_in(*connection, "select count(*) from audit where who = 'aside'"), 1);
  write_tiers(*connection);
  EXPECT_EQ(number_in(*connection,
                      "select cast(sum(count) as bigint) from minute_history "
                      "where bus = 'aside' and channel in ('a', 'b')"),
            5)
      << "minutes of the samples are noted after the transaction was rolled back";
  connection->script("drop index only_one");
  accept_all_samples(*connection);
}

// Any participant in the domain can publish an alarm with such a value.
void goes_on_after_an_alarm_without_a_number(const StoreAddress& address) {
  Store store(forever(address));
  const double infinity = std::numeric_limits<double>::infinity();
  store.put(AlarmRecord{"nan", "d", "c", "high", "active", std::nan(""), utc(8)});
  store.put(AlarmRecord{"nan", "d", "c", "high", "active", infinity, utc(9)});
  KeptAlarm kept{{"nan", "d", "c", LimitKind::kHigh}, {}};
  kept.status.active = true;
  kept.status.value = std::nan("");
  store.put(kept);
  store.append({.at = utc(8), .who = "nan"});
  ASSERT_TRUE(store.flush(seconds{30}));
  const auto connection = open_store(address, IfMissing::kFail);
  const bool sqlite = connection->dialect() == SqlConnection::Dialect::kSqlite;
  EXPECT_EQ(store.counters().quarantined, sqlite ? 2u : 0u) << "PostgreSQL stores NaN";
  EXPECT_EQ(number_in(*connection, "select count(*) from audit where who = 'nan'"), 1);
  EXPECT_EQ(number_in(*connection, "select count(*) from alarms where bus = 'nan'"),
            sqlite ? 1 : 2);
  for (const RefusedRow& row : quarantine_of(*connection)) EXPECT_EQ(row.content["value"], "nan");
  connection->script(
      "delete from alarms where bus = 'nan'; delete from alarm_states where bus = 'nan'");
}

void goes_on_after_every_extreme(const StoreAddress& address) {
  const std::vector<std::string> texts{"",
                                       std::string("a\0b", 3),
                                       std::string(1, '\0'),
                                       "\xff\xfe\xed\xa0\x80\xc0\x80",
                                       std::string(255, '\xff'),
                                       std::string(256, 'x'),
                                       "'; drop table alarms; --\r\n\x1b[31m\u202e",
                                       "\U0010ffff\U0001f525"};
  const std::vector<std::int64_t> numbers{INT64_MIN, INT64_MIN + 1, -1,       0,
                                          1,         INT64_MAX - 1, INT64_MAX};
  const std::vector<double> reals{std::nan(""),
                                  std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::max(),
                                  std::numeric_limits<double>::denorm_min(),
                                  -0.0};
  const auto connection = open_store(address, IfMissing::kFail);
  const std::int64_t audited = number_in(*connection, "select count(*) from audit");
  std::int64_t samples = 0, entries = 0;
  StoreCounters counters;
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("around", {"c"}));
    const auto put_sample = [&](const std::string& name, std::int64_t time, Value value) {
      const auto channel = store.number_of({.bus = name, .device = name, .channel = name});
      if (!channel) return;
      const SampleRow row{.channel = *channel,
                          .published_at = {time},
                          .acquired_at = {time},
                          .sequence = static_cast<std::uint64_t>(time),
                          .device_code = UINT16_MAX,
                          .value = std::move(value)};
      store.put(std::span(&row, 1));
      ++samples;
    };
    const auto put_events = [&](const std::string& text, std::int64_t time, double value) {
      const AlarmKey key{text, text, text, LimitKind::kHigh};
      store.append({{time}, text, text, text, UINT64_MAX, UINT64_MAX, text});
      ++entries;
      store.put(AlarmRecord{text, text, text, text, text, value, {time}});
      KeptAlarm kept{key, {}};
      kept.status.active = true;
      kept.status.value = value;
      kept.status.raised_at = kept.status.cleared_at = {time};
      kept.status.acknowledged = {text, text, {time}};
      kept.status.shelved = {text, text, {time}, {time}};
      store.put(kept);
      store.put(KeptMaintenance{{text, text}, {text, text, {time}, {time}}});
      store.put(AlarmEvent{{time}, key, AlarmEventKind::kShelved, text, text, {time}});
      store.put(DeviceRecord{text, text, text, text, text, {time}});
    };
    const Sample around[] = {sample(0, 1.0, 1, 1)};
    intake->put(around, kClock, utc(1));
    for (const std::string& text : texts) {
      put_sample(text, utc(1).nanoseconds, text);
      put_events(text, utc(1).nanoseconds, 1);
    }
    for (const std::int64_t number : numbers) {
      put_sample("extreme", number, number);
      put_sample("extreme", utc(1).nanoseconds, static_cast<std::uint64_t>(number));
      put_events("extreme", number, 1);
    }
    for (const double real : reals) {
      put_sample("extreme", utc(2).nanoseconds, real);
      put_events("extreme", utc(2).nanoseconds, real);
    }
    const Sample after[] = {sample(0, 1.0, 2, 2)};
    intake->put(after, kClock, utc(2));
    ASSERT_TRUE(store.flush(seconds{60}));
    counters = store.counters();
  }
  EXPECT_EQ(counters.dropped, 0u);
  const std::vector<RefusedRow> refused = quarantine_of(*connection);
  EXPECT_EQ(counters.quarantined, refused.size());
  const auto of_samples = std::ranges::count(refused, std::string("samples"), &RefusedRow::table);
  EXPECT_EQ(counters.stored, static_cast<std::uint64_t>(samples + 2 - of_samples));
  for (const RefusedRow& row : refused) {
    const bool at_the_end = row.table == "samples" && row.content["published_at"] == INT64_MAX;
    EXPECT_TRUE(at_the_end || row.content["value"] == "nan") << row.table << ' ' << row.content;
  }
  EXPECT_EQ(history(address, "around").size(), 2u);
  EXPECT_EQ(number_in(*connection, "select count(*) from audit"), audited + entries);
  for (const char* const view :
       {"sample_history", "last_samples", "alarm_history", "alarm_log", "alarm_list",
        "maintenance_list", "device_states", "audit_history"})
    EXPECT_GT(number_in(*connection, "select count(*) from " + std::string(view)), 0) << view;
  write_tiers(*connection);
  connection->script(
      "delete from alarms where value = 1 or bus = 'extreme'; delete from alarm_states; "
      "delete from device_maintenance; delete from alarm_events; delete from devices; "
      "delete from audit");
}

}  // namespace fieldcast::test
