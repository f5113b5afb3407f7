#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bridge/store/event_table.hpp"
#include "bridge/store/sql/schema.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr UtcTime kNoon{1'700'049'600'123'456'789};
constexpr std::int64_t kSecond = 1'000'000'000;

std::vector<std::vector<std::string>> rows_of(SqlConnection& connection, const std::string& sql) {
  std::vector<std::vector<std::string>> rows;
  connection.query(sql, {}, [&](const SqlRow& row) {
    auto& texts = rows.emplace_back();
    for (const SqlValue& value : row) {
      if (const auto* integer = std::get_if<std::int64_t>(&value)) {
        texts.push_back(std::to_string(*integer));
      } else if (const auto* real = std::get_if<double>(&value)) {
        char text[40];
        std::snprintf(text, sizeof text, "%.9g", *real);
        texts.emplace_back(text);
      } else if (const auto* text = std::get_if<std::string>(&value)) {
        texts.push_back(*text);
      } else {
        texts.emplace_back("null");
      }
    }
    return true;
  });
  return rows;
}

void insert(SqlConnection& connection, const std::string& channel, std::vector<Value> values,
            Quality quality = Quality::kGood) {
  SampleTable table(connection);
  const std::int64_t id = table.channel_id("line", "press", channel, "°C", "float32");
  std::vector<SampleRow> rows;
  for (Value& value : values) {
    const auto number = static_cast<std::int64_t>(rows.size());
    rows.push_back({.channel = id,
                    .published_at = {kNoon.nanoseconds + number * kSecond},
                    .acquired_at = {kNoon.nanoseconds + number * kSecond - 1'000'000},
                    .sequence = static_cast<std::uint64_t>(number + 1),
                    .quality = quality,
                    .value = std::move(value)});
  }
  table.insert(rows);
}

void shows_values_with_times(SqlConnection& connection) {
  const bool sqlite = connection.dialect() == SqlConnection::Dialect::kSqlite;
  insert(
      connection, "mixed",
      {true, std::int64_t{-5}, std::uint64_t{UINT64_MAX}, 2.5, std::nan(""), std::string("run")});
  EXPECT_THAT(
      rows_of(connection,
              "select sequence, value, text from sample_history where channel = 'mixed' "
              "order by sequence"),
      ElementsAre(ElementsAre("1", "1", "null"), ElementsAre("2", "-5", "null"),
                  ElementsAre("3", "1.84467441e+19", "null"), ElementsAre("4", "2.5", "null"),
                  ElementsAre("5", "null", "null"), ElementsAre("6", "null", "run")));
  EXPECT_THAT(rows_of(connection,
                      "select bus, device, unit, type, quality, published_at, acquired_at, "
                      "published_ns from sample_history where channel = 'mixed' limit 1"),
              ElementsAre(ElementsAre(
                  "line", "press", "°C", "float32", "GOOD",
                  sqlite ? "2023-11-15T12:00:00.123456789Z" : "2023-11-15 12:00:00.123456+00",
                  sqlite ? "2023-11-15T12:00:00.122456789Z" : "2023-11-15 12:00:00.122456+00",
                  "1700049600123456789")));
  EXPECT_THAT(
      rows_of(connection, "select sequence, text from last_samples where channel = 'mixed'"),
      ElementsAre(ElementsAre("6", "run")));
}

void shows_every_quality_by_its_name(SqlConnection& connection) {
  for (int number = 0; number <= static_cast<int>(Quality::kNotYetRead); ++number) {
    const auto quality = static_cast<Quality>(number);
    const std::string name(to_text(quality));
    insert(connection, name, {1.0}, quality);
    EXPECT_THAT(
        rows_of(connection, "select quality from last_samples where channel = '" + name + "'"),
        ElementsAre(ElementsAre(name)));
  }
}

void shows_events_with_times(SqlConnection& connection) {
  const std::string noon = connection.dialect() == SqlConnection::Dialect::kSqlite
                               ? "2023-11-15T12:00:00.123456789Z"
                               : "2023-11-15 12:00:00.123456+00";
  EventTable events(connection);
  events.insert(AlarmRecord{"line", "press", "t", "high", "active", 80, kNoon});
  events.insert(AlarmRecord{"line", "press", "t", "low", "active", 1, kNoon});
  events.insert(AlarmRecord{"line", "press", "t", "low", "clear", 5, kNoon});
  events.insert(DeviceRecord{"line", "press", "modbus-rtu", "1", "online", kNoon});
  events.insert(DeviceRecord{"line", "mill", "modbus-rtu", "2", "unknown", UtcTime{}});
  events.insert(AuditEntry{
      .at = kNoon, .who = "ann", .what = "write 5", .target = "line/press/t", .result = "done"});
  EXPECT_THAT(rows_of(connection, "select limit_kind, value, since from active_alarms"),
              ElementsAre(ElementsAre("high", "80", noon)));
  EXPECT_THAT(rows_of(connection, "select state, since from alarm_history order by id"),
              ElementsAre(ElementsAre("active", noon), ElementsAre("active", noon),
                          ElementsAre("clear", noon)));
  EXPECT_THAT(
      rows_of(connection, "select device, state, since from device_states order by device"),
      ElementsAre(ElementsAre("mill", "unknown", "null"), ElementsAre("press", "online", noon)));
  EXPECT_THAT(rows_of(connection, "select who, what, result, at from audit_history"),
              ElementsAre(ElementsAre("ann", "write 5", "done", noon)));
}

void all_views(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  if (connection->dialect() == SqlConnection::Dialect::kPostgres)
    connection->script("set timezone = 'UTC'");
  shows_values_with_times(*connection);
  shows_every_quality_by_its_name(*connection);
  shows_events_with_times(*connection);
}

void an_older_store_gets_its_views(const StoreAddress& address) {
  {
    const auto connection = open_store(address, IfMissing::kCreate);
    insert(*connection, "old", {7.0});
    test::back_to_version(*connection, 3);
    EXPECT_THROW(rows_of(*connection, "select * from last_samples"), StoreError);
  }
  const auto connection = open_store(address, IfMissing::kFail);
  EXPECT_THAT(rows_of(*connection, "select value from last_samples where channel = 'old'"),
              ElementsAre(ElementsAre("7")));
}

TEST(StoreViews, OfSqliteShowValuesQualitiesAndTimes) {
  const test::Scratch scratch;
  all_views(StoreAddress(scratch.path("store.db")));
}

TEST(StoreViews, OfSqliteComeToAnOlderStoreWhenItIsOpened) {
  const test::Scratch scratch;
  an_older_store_gets_its_views(StoreAddress(scratch.path("store.db")));
}

TEST(StoreViews, OfSqliteReadTheWantedSamplesOnly) {
  const test::Scratch scratch;
  const auto connection = open_store(StoreAddress(scratch.path("store.db")), IfMissing::kCreate);
  const auto plan_of = [&](const std::string& sql) {
    std::string plan;
    for (const auto& row : rows_of(*connection, "explain query plan " + sql)) plan += row[3] + '\n';
    return plan;
  };
  const std::string range = "published_ns >= 1 and published_ns < 9";
  for (const std::string& wanted : {"bus = 'b' and " + range, range}) {
    EXPECT_THAT(plan_of("select value from sample_history where " + wanted),
                HasSubstr("SEARCH s USING PRIMARY KEY (channel=? AND published_at>?"));
  }
  EXPECT_THAT(plan_of("select value from last_samples"),
              HasSubstr("SEARCH s USING PRIMARY KEY (channel=? AND published_at=?"));
}

TEST(StoreViews, OfPostgresDoTheSame) {
  test::with_postgres([](test::PostgresServer& server) {
    all_views(server.address());
    an_older_store_gets_its_views(server.address());
  });
}

}  // namespace
}  // namespace fieldcast
