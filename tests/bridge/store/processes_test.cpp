// Tests an SQLite store that the bridge (two connections) and a command line have open.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bridge/store/event_table.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

using test::Scratch;

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
