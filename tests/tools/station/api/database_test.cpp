#include "tools/station/api/base/database.hpp"

#include <future>

#include "tests/bridge/store/postgres_server.hpp"
#include "tests/tools/station/api/api_support.hpp"

namespace fieldcast::web {
namespace {

using namespace std::chrono_literals;
using DatabaseTest = test::ApiTest;

std::int64_t count(SqlConnection& connection) {
  std::int64_t found = -1;
  connection.query("select count(*) from channels", {}, [&](const SqlRow& row) {
    found = integer_at(row, 0);
    return true;
  });
  return found;
}

using Result = tl::expected<std::int64_t, DatabaseFault>;

TEST_F(DatabaseTest, RespondsOnTheIoThread) {
  store([](Store&) {});
  std::optional<Result> result;
  std::thread::id answered;
  database()->query<std::int64_t>(count, [&](Result given) {
    result = given;
    answered = std::this_thread::get_id();
  });
  ASSERT_TRUE(io_.run_until([&] { return result.has_value(); }));
  EXPECT_EQ(*result, 0);
  EXPECT_EQ(answered, std::this_thread::get_id());
  EXPECT_EQ(database()->counters().completed, 1u);
}

TEST_F(DatabaseTest, OneQuestionTooManyIsRefused) {
  store([](Store&) {});
  std::promise<void> begun, end;
  int answers = 0, refusals = 0;
  const auto done = [&](Result given) {
    ++(given ? answers : refusals);
    EXPECT_TRUE(given || given.error() == DatabaseFault::kBusy);
  };
  database()->query<std::int64_t>(
      [&](SqlConnection& connection) {
        begun.set_value();
        end.get_future().wait();
        return count(connection);
      },
      done);
  begun.get_future().wait();
  for (std::size_t i = 1; i < Database::kMaxWaiting; ++i)
    database()->query<std::int64_t>(count, done);
  database()->query<std::int64_t>(count, done);
  database()->query_further<std::int64_t>(count, done);
  end.set_value();
  ASSERT_TRUE(io_.run_until([&] { return answers + refusals == 66; }));
  EXPECT_EQ(refusals, 1);
  EXPECT_EQ(database()->counters().busy, 1u);
  EXPECT_EQ(response_of(DatabaseFault::kBusy).status, 503u);
}

// Regression: the station could not read its users while clients sent many requests.
TEST_F(DatabaseTest, AnUrgentQueryRunsBeforeAllThatWait) {
  store([](Store&) {});
  std::promise<void> begun, end;
  std::vector<int> order;
  const auto done = [&](int number) {
    return [&order, number](const Result& given) { order.push_back(given ? number : -number); };
  };
  database()->query<std::int64_t>(
      [&](SqlConnection& connection) {
        begun.set_value();
        end.get_future().wait();
        return count(connection);
      },
      done(1));
  begun.get_future().wait();
  for (std::size_t i = 1; i < Database::kMaxWaiting; ++i)
    database()->query<std::int64_t>(count, done(2));
  database()->query_urgent<std::int64_t>(count, done(3));
  end.set_value();
  ASSERT_TRUE(io_.run_until([&] { return order.size() == Database::kMaxWaiting + 1; }));
  EXPECT_EQ(order[0], 1);
  EXPECT_EQ(order[1], 3);
  EXPECT_EQ(database()->counters().busy, 0u);
}

TEST_F(DatabaseTest, AStoreThatIsNotThereYetIsOpenedWhenItIs) {
  std::optional<Result> result;
  const auto ask = [&] {
    result.reset();
    database()->query<std::int64_t>(count, [&](Result given) { result = given; });
    ASSERT_TRUE(io_.run_until([&] { return result.has_value(); }));
  };
  ask();
  EXPECT_EQ(result->error(), DatabaseFault::kAway);
  store([](Store&) {});
  ask();
  EXPECT_EQ(**result, 0);
}

TEST_F(DatabaseTest, WhoStillWaitsAtTheEndIsNotified) {
  store([](Store&) {});
  std::promise<void> begun;
  int answers = 0, refusals = 0;
  const auto done = [&](Result given) { ++(given ? answers : refusals); };
  database()->query<std::int64_t>(
      [&](SqlConnection& connection) {
        begun.set_value();
        std::this_thread::sleep_for(100ms);
        return count(connection);
      },
      done);
  database()->query<std::int64_t>(count, done);
  begun.get_future().wait();
  database_.reset();
  ASSERT_TRUE(io_.run_until([&] { return answers + refusals == 2; }));
  EXPECT_EQ(refusals, 1);
}

void changes_nothing(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  make_read_only(*connection);
  EXPECT_THROW(connection->execute("delete from users", SqlRow{}), StoreError);
  EXPECT_EQ(count(*connection), 0);
}

void ends_what_takes_too_long(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  connection->limit(std::chrono::steady_clock::now() - 1s);
  EXPECT_THROW(count(*connection), StoreTooSlow);
  connection->limit(std::chrono::steady_clock::now() + 1min);
  EXPECT_EQ(count(*connection), 0) << "the connection is as good as before";
}

TEST_F(DatabaseTest, SqliteChangesNothingAndEndsWhatTakesTooLong) {
  changes_nothing(address());
  ends_what_takes_too_long(address());
  const auto connection = open_store(address(), IfMissing::kFail);
  connection->limit(std::chrono::steady_clock::now() + 50ms);
  const auto began = std::chrono::steady_clock::now();
  EXPECT_THROW(connection->query("with recursive n(i) as (select 1 union all select i + 1 from n) "
                                 "select count(*) from n",
                                 {}, [](const SqlRow&) { return true; }),
               StoreTooSlow);
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s);
}

TEST(DatabaseAtPostgres, ChangesNothingAndEndsWhatTakesTooLong) {
  if (fieldcast::test::PostgresServer::programs().empty())
    GTEST_SKIP() << "PostgreSQL is not installed";
  const fieldcast::test::PostgresServer server;
  ASSERT_TRUE(server.ready());
  changes_nothing(server.address());
  ends_what_takes_too_long(server.address());
  const auto connection = open_store(server.address(), IfMissing::kFail);
  connection->script("set statement_timeout = 50");
  EXPECT_THROW(connection->query("select 1 from (select pg_sleep(20)) s", {},
                                 [](const SqlRow&) { return true; }),
               StoreTooSlow);
  EXPECT_EQ(count(*connection), 0);
}

}  // namespace
}  // namespace fieldcast::web
