// Runs every query of the store's dashboards (config/grafana) with Grafana's macros and variables
// replaced, and checks that it finds the rows of a store at their times.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "bridge/store/event_table.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using nlohmann::json;

constexpr std::int64_t kNanosecondsOfSecond = 1'000'000'000;
constexpr std::int64_t kNine = 1'700'038'800;  // 2023-11-15T09:00:00Z, in seconds
constexpr UtcTime kAt{(kNine + 10) * kNanosecondsOfSecond + 500'000'000};
constexpr std::int64_t kFrom = kNine, kTo = kNine + 60;

struct Query {
  std::string where;  // the panel or the variable
  std::string sql;
};

std::string text_of_query(const json& query) {
  if (query.is_string()) return query;
  return query.contains("rawSql") ? query.at("rawSql") : query.at("rawQueryText");
}

std::vector<Query> queries_of(const std::string& file) {
  const json dashboard =
      json::parse(std::ifstream(std::string(FIELDCAST_SOURCE) + "/config/grafana/" + file));
  std::vector<Query> found;
  for (const json& variable : dashboard.at("templating").at("list")) {
    if (variable.at("type") == "query")
      found.push_back({variable.at("name"), text_of_query(variable.at("query"))});
  }
  for (const json& panel : dashboard.at("panels")) {
    for (const json& target : panel.at("targets"))
      found.push_back({panel.at("title"), text_of_query(target)});
  }
  return found;
}

std::string replaced(const std::string& text, const std::string& pattern, const std::string& by) {
  return std::regex_replace(text, std::regex(pattern), by);
}

// Expands as Grafana does: grafana.com/docs/grafana/latest/datasources/postgres, "Macros", and its
// global variables; the interval is 10 s.
std::string expanded(std::string sql) {
  sql = replaced(sql, R"(\$__unixEpochNanoFilter\((\w+)\))",
                 fmt::format("$1 >= {} and $1 <= {}", kFrom * kNanosecondsOfSecond,
                             kTo * kNanosecondsOfSecond));
  sql = replaced(sql, R"(\$__timeGroupAlias\((\w+), \$__interval\))",
                 "floor(extract(epoch from $1)/10)*10 AS \"time\"");
  sql = replaced(sql, R"(\$__interval_ms)", "10000");
  sql = replaced(sql, R"(\$__from)", std::to_string(kFrom * 1000));
  sql = replaced(sql, R"(\$__to)", std::to_string(kTo * 1000));
  sql = replaced(sql, R"(\$\{bus:sqlstring\})", "'line','other'");
  sql = replaced(sql, R"(\$\{device:sqlstring\})", "'press'");
  sql = replaced(sql, R"(\$\{channel:sqlstring\})", "'temperature','it''s'");
  return sql;
}

void fill(SqlConnection& connection) {
  SampleTable samples(connection);
  const auto put = [&](const char* channel, Quality quality, Value value, std::uint64_t sequence) {
    const SampleRow row{.channel = samples.channel_id("line", "press", channel, "°C", "float32"),
                        .published_at = kAt,
                        .acquired_at = kAt,
                        .sequence = sequence,
                        .quality = quality,
                        .value = std::move(value)};
    samples.insert(std::span(&row, 1));
  };
  put("temperature", Quality::kGood, 20.5, 1);
  put("temperature", Quality::kBadFrame, 20.5, 2);
  put("it's", Quality::kGood, std::string("run"), 1);
  EventTable events(connection);
  events.insert(DeviceRecord{"line", "press", "modbus-rtu", "1", "online", kAt});
  events.insert(DeviceRecord{"line", "mill", "modbus-rtu", "2", "offline", kAt});
  events.insert(AlarmRecord{"line", "press", "temperature", "high", "active", 80, kAt});
  events.insert(AuditEntry{
      .at = kAt, .who = "ann", .what = "write 5", .target = "line/press/t", .result = "done"});
}

bool is_the_day(const std::string& text) {
  if (std::regex_match(text, std::regex(R"(2023-11-15[T ]09:00:10\.5\d*(Z|\+00))"))) return true;
  double epoch = 0;
  std::from_chars(text.data(), text.data() + text.size(), epoch);
  return epoch == kNine + 10;
}

bool shows_times(const std::string& sql) {
  return std::regex_search(
      sql, std::regex(R"(as time|timeGroup|select since|select at|, since|acquired_at)"));
}

void every_query_finds_its_rows(const std::string& file, SqlConnection& connection) {
  const std::vector<Query> queries = queries_of(file);
  EXPECT_GE(queries.size(), 12u);
  for (const Query& query : queries) {
    SCOPED_TRACE(file + ": " + query.where + ": " + expanded(query.sql));
    int rows = 0;
    bool has_time = false;
    const auto look = [&](const SqlRow& row) {
      ++rows;
      for (const SqlValue& value : row) {
        if (const auto* text = std::get_if<std::string>(&value)) has_time |= is_the_day(*text);
        if (const auto* whole = std::get_if<std::int64_t>(&value))
          has_time |= is_the_day(std::to_string(*whole));
        if (const auto* real = std::get_if<double>(&value))
          has_time |= is_the_day(std::to_string(*real));
      }
      return true;
    };
    ASSERT_NO_THROW(connection.query(expanded(query.sql), {}, look));
    EXPECT_GT(rows, 0);
    EXPECT_TRUE(has_time || !shows_times(query.sql));
  }
}

TEST(StoreDashboard, OfSqliteFindsRowsInEveryQuery) {
  const test::Scratch scratch;
  const auto connection = open_store(StoreAddress(scratch.path("store.db")), IfMissing::kCreate);
  fill(*connection);
  every_query_finds_its_rows("store-sqlite.json", *connection);
}

TEST(StoreDashboard, OfPostgresFindsRowsInEveryQueryForWhoMayReadTheViewsOnly) {
  test::with_postgres([](test::PostgresServer& server) {
    const auto connection = open_store(server.address(), IfMissing::kCreate);
    fill(*connection);
    connection->script(
        "create role grafana login;"  // as in docs/store.md
        "grant select on sample_history, last_samples, device_states, alarm_history, "
        "active_alarms, "
        "audit_history to grafana; set role grafana; set timezone = 'UTC'");
    EXPECT_THROW(connection->script("select * from users"), StoreError);
    every_query_finds_its_rows("store.json", *connection);
  });
}

}  // namespace
}  // namespace fieldcast
