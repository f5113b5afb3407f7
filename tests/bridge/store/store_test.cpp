#include "bridge/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "bridge/store/event_table.hpp"
#include "bridge/store/sql/schema.hpp"
#include "bridge/store/sql/sql.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;

TEST(Store, DropsAndCountsWhatFindsNoRoomAndNeverWaits) {
  const Scratch scratch;
  const std::string folder = scratch.path("later");
  Store store(forever(StoreAddress(folder + "/store.db")));
  const auto intake = store.intake(bus_of("bus", {"a"}));
  const std::vector<Sample> many(1000, sample(0, 1.0, 0));
  std::uint64_t put = 0;
  for (; store.counters().dropped == 0; put += many.size()) {
    ASSERT_LT(put, 10 * Store::kMaxWaiting);
    intake->put(many, kClock, utc(static_cast<std::int64_t>(put)));
  }
  std::filesystem::create_directory(folder);
  ASSERT_TRUE(store.flush(seconds{60})) << "the store opens when its folder comes";
  const auto counters = store.counters();
  EXPECT_EQ(counters.stored + counters.dropped, put);
  EXPECT_GE(counters.stored, Store::kMaxWaiting);
  EXPECT_EQ(counters.waiting, 0u);
}

TEST(Store, WritesWhatWaitsWhenItCloses) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  {
    Store store(forever(address));
    const Sample one[] = {sample(0, 1.0, 0)};
    store.intake(bus_of("bus", {"a"}))->put(one, kClock, utc(0));
  }
  EXPECT_EQ(history(address, "bus").size(), 1u);
}

[[noreturn]] void store_and_tell(const std::string& path, int tell) {
  Store store(forever(StoreAddress(path)));
  const auto intake = store.intake(bus_of("bus", {"a"}));
  for (std::uint64_t sequence = 1;; ++sequence) {
    const Sample one[] = {
        sample(0, std::uint64_t{sequence}, static_cast<std::int64_t>(sequence), sequence)};
    intake->put(one, kClock, utc(static_cast<std::int64_t>(sequence)));
    if (sequence % 1000 != 0) continue;
    const std::uint64_t stored = store.counters().stored;
    if (::write(tell, &stored, sizeof stored) != sizeof stored) ::_exit(1);
    while (store.counters().waiting > 50'000) std::this_thread::yield();
  }
}

TEST(Store, KeepsWhatWasReportedStoredWhenTheProcessIsKilled) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) store_and_tell(address.text(), ends[1]);
  ::close(ends[1]);
  std::uint64_t reported = 0, now = 0;
  while (reported < 100'000 && ::read(ends[0], &now, sizeof now) == sizeof now) reported = now;
  ::kill(child, SIGKILL);
  while (::read(ends[0], &now, sizeof now) == sizeof now) reported = now;
  ::waitpid(child, nullptr, 0);
  ::close(ends[0]);
  ASSERT_GE(reported, 100'000u);
  const auto found = history(address, "bus");
  ASSERT_GE(found.size(), reported);
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_EQ(found[i].sequence, i + 1) << "without a hole";
}

}  // namespace
}  // namespace fieldcast::test

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using test::history;
using test::Scratch;
using testing::HasSubstr;
using testing::Not;

TEST(PostgresStore, SaysWhatIsWrongWithoutThePassword) {
  for (const std::string text :
       {"postgresql://ann:secret@127.0.0.1:1/db", "postgresql://ann:sec:ret@secret@127.0.0.1:1/db",
        "postgresql://ann@127.0.0.1:1/db?password=secret&connect_timeout=1",
        "postgresql://ann:secret@[broken"}) {
    try {
      (void)open_store(StoreAddress(text), IfMissing::kFail);
      ADD_FAILURE() << "opened " << text;
    } catch (const StoreError& error) {
      EXPECT_THAT(error.what(), HasSubstr("***"));
      EXPECT_THAT(error.what(), Not(HasSubstr("secret")));
    }
  }
}

TEST(StoreAddress, ShowsNoPassword) {
  EXPECT_EQ(StoreAddress("/var/lib/plant.db").masked(), "/var/lib/plant.db");
  EXPECT_EQ(StoreAddress("postgresql://ann@host/db").masked(), "postgresql://ann@host/db");
  EXPECT_EQ(StoreAddress("postgresql://ann:se/cr@et@host:5432/db").masked(),
            "postgresql://ann:***@host:5432/db");
  EXPECT_EQ(StoreAddress("postgres:///db?password=x&user=ann").masked(),
            "postgres:///db?password=***&user=ann");
  EXPECT_TRUE(StoreAddress("postgresql://ann:se/cret@host/db").is_ambiguous());
  EXPECT_FALSE(StoreAddress("postgresql://ann:se%2Fcret@host/db?user=a@b").is_ambiguous());
  EXPECT_TRUE(StoreAddress("postgres:///db").is_server());
  EXPECT_FALSE(StoreAddress("postgresql.db").is_server());
}

constexpr std::chrono::seconds kSoon{30};
constexpr milliseconds kWhile{2500};

// `fill` makes the database reject writes, `empty` undoes that.
template <typename Fill, typename Empty>
void waits_while_it_is_full(const StoreAddress& address, Fill fill, Empty empty) {
  Store store(test::forever(address));
  const auto intake = store.intake(test::bus_of("b", {"c"}));
  const auto put = [&](std::int64_t second) {
    const Sample one[] = {test::sample(0, 0.5, second, static_cast<std::uint64_t>(second))};
    intake->put(one, test::kClock, test::utc(second));
  };
  put(1);
  ASSERT_TRUE(store.flush(kSoon));
  fill();
  put(2);
  EXPECT_FALSE(store.flush(kWhile));
  put(3);
  EXPECT_EQ(store.counters().stored, 1u);
  EXPECT_EQ(store.counters().dropped, 0u);
  empty();
  ASSERT_TRUE(store.flush(kSoon));
  EXPECT_EQ(store.counters().stored, 3u);
  EXPECT_EQ(history(address, "b").size(), 3u);
}

TEST(SqliteStore, ThatIsFullIsWaitedForAndLosesNothing) {
  const test::Scratch scratch;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto limit = [&](rlim_t bytes) {
    const rlimit wanted{bytes, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &wanted), 0);
  };
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  waits_while_it_is_full(
      StoreAddress(scratch.path("store.db")), [&] { limit(1); }, [&] { limit(before.rlim_cur); });
  limit(before.rlim_cur);
  (void)std::signal(SIGXFSZ, signal_before);
}

TEST(PostgresStore, ThatCanOnlyBeReadIsWaitedForAndLosesNothing) {
  test::with_postgres([](test::PostgresServer& server) {
    const auto operator_of_it = open_store(server.address(), IfMissing::kCreate);
    const auto set_read_only = [&](const std::string& value) {
      operator_of_it->script("set default_transaction_read_only = off");
      operator_of_it->script("alter system set default_transaction_read_only = " + value);
      operator_of_it->script("select pg_reload_conf()");
    };
    waits_while_it_is_full(
        server.address(), [&] { set_read_only("on"); }, [&] { set_read_only("off"); });
  });
}

TEST(PostgresStore, ThatIsLockedIsWaitedForAndLosesNothing) {
  test::with_postgres([](test::PostgresServer& server) {
    const auto other = open_store(server.address(), IfMissing::kCreate);
    waits_while_it_is_full(
        StoreAddress(server.address().text() + "&options=-c%20lock_timeout%3D50ms"),
        [&] { other->script("begin; lock table open_buckets in access exclusive mode"); },
        [&] { other->script("rollback"); });
  });
}

TEST(SqliteStore, ThatIsLockedIsBusy) {
  const test::Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  const auto other = open_store(address, IfMissing::kCreate);
  const auto connection = open_store(address, IfMissing::kFail);
  connection->script("pragma busy_timeout = 10");
  other->script("begin immediate");
  EXPECT_THROW(EventTable(*connection).insert(AuditEntry{.who = "ann"}), StoreBusy);
  other->script("rollback");
  EventTable(*connection).insert(AuditEntry{.who = "ann"});
}

// Tests an SQLite store that the bridge (two connections) and a command line have open.

std::size_t entries_of(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kFail);
  std::size_t count = 0;
  EventTable(*connection).audit(UtcTime{}, UtcTime{INT64_MAX}, [&](const AuditEntry&) {
    return ++count > 0;
  });
  return count;
}

// A process that reads the store on request. Forked before this process opens the store: SQLite
// connections must not cross a fork.
class Reader {
 public:
  explicit Reader(const StoreAddress& address) {
    int ends[2];
    if (::pipe(ends) != 0) std::abort();
    child_ = ::fork();
    if (child_ == 0) {
      ::close(ends[1]);
      char go = 0;
      if (::read(ends[0], &go, 1) != 1) ::_exit(2);
      try {
        ::_exit(entries_of(address) == 1 ? 0 : 1);
      } catch (const StoreError&) { ::_exit(3); }
    }
    ::close(ends[0]);
    go_ = ends[1];
  }
  [[nodiscard]] int look() {
    int status = -1;
    if (::write(go_, "x", 1) != 1) return -1;
    ::close(go_);
    ::waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t child_ = -1;
  int go_ = -1;
};

TEST(SqliteStore, LosesNothingWhenAnotherProcessLeavesItWhileThisOneHasItOpenTwice) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  Reader reader(address);
  const auto writer = open_store(address, IfMissing::kCreate);
  EventTable table(*writer);
  table.insert(AuditEntry{.at = UtcTime{1}, .who = "ann", .what = "login"});
  const auto logins = open_store(address, IfMissing::kFail);
  ASSERT_EQ(reader.look(), 0);
  table.insert(AuditEntry{.at = UtcTime{2}, .who = "bob", .what = "login"});
  EXPECT_EQ(entries_of(address), 2u);
}

}  // namespace
}  // namespace fieldcast
