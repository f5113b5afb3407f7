#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "bridge/store/store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using test::history;

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
  if (test::PostgresServer::programs().empty())
    GTEST_SKIP() << "no PostgreSQL server here (Debian: postgresql): not tested";
  test::PostgresServer server;
  ASSERT_TRUE(server.ready()) << "the server did not start";
  const auto operator_of_it = open_store(server.address(), IfMissing::kCreate);
  const auto set_read_only = [&](const std::string& value) {
    operator_of_it->script("set default_transaction_read_only = off");
    operator_of_it->script("alter system set default_transaction_read_only = " + value);
    operator_of_it->script("select pg_reload_conf()");
  };
  waits_while_it_is_full(
      server.address(), [&] { set_read_only("on"); }, [&] { set_read_only("off"); });
}

}  // namespace
}  // namespace fieldcast
