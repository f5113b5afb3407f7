#include "bridge/store/store.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast {
namespace {

using std::chrono::seconds;
using test::bus_of;
using test::forever;
using test::history;
using test::kClock;
using test::sample;
using test::Scratch;
using test::utc;

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
}  // namespace fieldcast
