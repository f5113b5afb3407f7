// Tests that another bridge on the same store recognises the identities of commands.
#include "bridge/store/command_id_table.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <future>

#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using std::chrono::seconds;
using test::Scratch;
using testing::ElementsAre;
using Verdict = CommandIdTable::Verdict;

Verdict enter(CommandIdTable& identities, const std::string& requester, std::uint64_t id) {
  auto verdict = std::make_shared<std::promise<Verdict>>();
  auto known = verdict->get_future();
  identities.enter(requester, id, [verdict](Verdict v) { verdict->set_value(v); });
  if (known.wait_for(seconds{15}) == std::future_status::ready) return known.get();
  ADD_FAILURE() << "no verdict";
  return Verdict::kNotKept;
}

void outlive_their_bridge(const StoreAddress& address) {
  constexpr std::uint64_t kHigh = UINT64_MAX - 1;
  {
    CommandIdTable first(address);
    EXPECT_EQ(enter(first, "a", 1), Verdict::kNew);
    EXPECT_EQ(enter(first, "a", 1), Verdict::kKnown);
    EXPECT_EQ(enter(first, "a", kHigh), Verdict::kNew);
  }
  CommandIdTable second(address);
  EXPECT_EQ(enter(second, "a", 1), Verdict::kKnown);
  EXPECT_EQ(enter(second, "a", kHigh), Verdict::kKnown);
  EXPECT_EQ(enter(second, "b", 1), Verdict::kNew);
  EXPECT_EQ(enter(second, "a", 2), Verdict::kNew);
}

TEST(CommandIdTable, OutliveTheirBridge) {
  const Scratch scratch;
  outlive_their_bridge(StoreAddress(scratch.path("store.db")));
}

TEST(CommandIdTable, OutliveTheirBridgeInPostgres) {
  test::with_postgres([](test::PostgresServer& server) { outlive_their_bridge(server.address()); });
}

// The killed bridge has returned "new" and may have run the command, so the next must not.
TEST(CommandIdTable, OutliveABridgeThatIsKilledAtTheVerdict) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  const pid_t child = ::fork();
  if (child == 0) {
    CommandIdTable dying(address);
    dying.enter("a", 1, [](Verdict) { ::kill(::getpid(), SIGKILL); });
    ::pause();
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  CommandIdTable next(address);
  EXPECT_EQ(enter(next, "a", 1), Verdict::kKnown);
}

TEST(CommandIdTable, AreNotKeptByAStoreThatIsAway) {
  const Scratch scratch;
  CommandIdTable identities(StoreAddress(scratch.path("no-such-folder/store.db")));
  EXPECT_EQ(enter(identities, "a", 1), Verdict::kNotKept);
}

TEST(CommandIdTable, OfLongAgoAreForgotten) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  const auto connection = open_store(address, IfMissing::kCreate);
  for (std::int64_t id = 0; id < 3000; ++id)
    connection->execute("insert into commands values ($1, $2, $3)", SqlRow{"old", id, id});
  CommandIdTable identities(address);
  for (std::uint64_t id = 0; id < 2100; ++id) enter(identities, "new", id);
  std::vector<std::int64_t> left;
  connection->query(
      "select count(*) from commands where requester = 'old' union all "
      "select count(*) from commands where requester = 'new'",
      {}, [&](const SqlRow& row) {
        left.push_back(integer_at(row, 0));
        return true;
      });
  EXPECT_THAT(left, ElementsAre(0, 2100));
}

}  // namespace
}  // namespace fieldcast
