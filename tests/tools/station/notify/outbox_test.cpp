#include "tools/station/notify/outbox.hpp"

#include <gmock/gmock.h>

#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tools/station/notify/notifier.hpp"

namespace fieldcast::web {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;
using test::Scratch;

constexpr UtcTime kMade{1'790'000'000'000'000'000};
constexpr Duration kDay = hours{24};

UtcTime after(Duration time) { return {kMade.nanoseconds + time.count()}; }

Notification queued(const std::string& id, UtcTime at = kMade) {
  return {id, "crew", "ann@plant.example", at, "subject", "text", "{}"};
}

std::string next_id(Outbox& outbox, UtcTime now) {
  const auto found = outbox.next("crew", now);
  return found ? found->id : "";
}

void keeps_what_is_committed(const StoreAddress& address) {
  const AlarmKey alarm{"b", "d", "c", LimitKind::kLow};
  RuleEngine::Due due;
  due.progress = {{.rule = "r",
                   .alarm = alarm,
                   .state = NotifyProgress::State::kAcknowledged,
                   .occurrence = kMade,
                   .first_at = after(seconds{1}),
                   .last_at = after(seconds{2}),
                   .count = 3,
                   .escalated = 1,
                   .returned = NotifyProgress::Return::kReported}};
  due.windows = {{"r", "crew", kMade, 2, "line\n", 4}, {"r", "chat", kMade, 1}};
  {
    Outbox outbox(address, 10, kDay);
    ASSERT_TRUE(outbox.load());
    ASSERT_TRUE(outbox.commit(due, {queued("one"), queued("two", after(seconds{1}))}, kMade));
    EXPECT_EQ(outbox.counters().waiting, 2u);
    EXPECT_EQ(next_id(outbox, kMade), "one");
    outbox.sent("one", kMade);
  }
  Outbox second(address, 10, kDay);
  const auto kept = second.load();
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->progress, due.progress);
  EXPECT_EQ(kept->windows.size(), 2u);
  // A message that is derived again is neither queued nor sent again.
  ASSERT_TRUE(
      second.commit({.windows = {{"r", "chat", {}}}}, {queued("one"), queued("two")}, kMade));
  EXPECT_EQ(second.load()->windows, (std::vector<NotifyWindow>{due.windows[0]}));
  EXPECT_EQ(next_id(second, after(minutes{1})), "two");
  const auto found = second.next("crew", after(minutes{1}));
  EXPECT_EQ(static_cast<const Notification&>(*found), queued("two", after(seconds{1})));
  second.failed("two", "no route", after(minutes{5}));
  EXPECT_EQ(next_id(second, after(minutes{4})), "");
  EXPECT_EQ(second.next("crew", after(minutes{5}))->attempts, 1u);
  second.sent("two", after(minutes{5}));
  EXPECT_EQ(next_id(second, after(kDay)), "");
  EXPECT_EQ(second.counters().waiting, 0u);
}

TEST(Outbox, KeepsWhatIsCommitted) {
  const Scratch scratch;
  keeps_what_is_committed(StoreAddress(scratch.path("store.db")));
}

TEST(Outbox, KeepsWhatIsCommittedInPostgres) {
  test::with_postgres(
      [](test::PostgresServer& server) { keeps_what_is_committed(server.address()); });
}

TEST(Outbox, DropsTheOldestBeyondItsLimit) {
  const Scratch scratch;
  Outbox outbox(StoreAddress(scratch.path("store.db")), 3, kDay);
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(outbox.commit({}, {queued(std::to_string(i), after(seconds{i}))}, kMade));
  EXPECT_EQ(outbox.counters().lost, 2u);
  EXPECT_EQ(next_id(outbox, after(minutes{1})), "2");
}

TEST(Outbox, AMessageIsKeptForItsTimeAndThenExpires) {
  const Scratch scratch;
  Outbox outbox(StoreAddress(scratch.path("store.db")), 10, kDay);
  ASSERT_TRUE(outbox.commit({}, {queued("old"), queued("new", after(hours{1}))}, kMade));
  outbox.tidy(after(kDay));
  EXPECT_EQ(outbox.counters().lost, 0u);
  outbox.tidy(after(kDay + seconds{1}));
  EXPECT_EQ(outbox.counters().lost, 1u);
  EXPECT_EQ(next_id(outbox, after(kDay + seconds{1})), "new");
}

TEST(Outbox, WaitsNoLongerWhenTheClockIsSetBack) {
  const Scratch scratch;
  Outbox outbox(StoreAddress(scratch.path("store.db")), 10, kDay);
  ASSERT_TRUE(outbox.commit({}, {queued("one")}, kMade));
  outbox.failed("one", "no route", after(minutes{10}));
  EXPECT_EQ(next_id(outbox, kMade), "");
  EXPECT_EQ(next_id(outbox, after(-hours{1})), "one");
}

// A message that was sent, but could not be stored as sent, holds its target until it is stored.
TEST(Outbox, WaitsUntilItIsStoredThatAMessageWasSent) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  Outbox outbox(address, 10, kDay);
  ASSERT_TRUE(outbox.commit({}, {queued("one"), queued("two")}, kMade));
  auto other = open_store(address, IfMissing::kFail);
  other->script("alter table notifications rename to hidden");
  outbox.sent("one", kMade);
  EXPECT_EQ(next_id(outbox, kMade), "");
  other->script("alter table hidden rename to notifications");
  EXPECT_EQ(next_id(outbox, kMade), "two");
  EXPECT_EQ(outbox.counters().sent, 1u);
}

TEST(PauseAfter, DoublesUpToItsLimit) {
  EXPECT_EQ(pause_after(0, minutes{10}), seconds{2});
  EXPECT_EQ(pause_after(3, minutes{10}), seconds{16});
  EXPECT_EQ(pause_after(20, minutes{10}), minutes{10});
  EXPECT_EQ(pause_after(4'000'000'000u, minutes{10}), minutes{10});
}

}  // namespace
}  // namespace fieldcast::web
