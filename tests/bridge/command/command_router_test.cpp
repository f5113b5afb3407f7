#include "bridge/command/command_router.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "tests/bridge/support/pty.hpp"
#include "tests/bridge/support/recording_sink.hpp"

namespace fieldcast {
namespace {

Command command(std::uint64_t id) {
  Command made;
  made.requester = "test";
  made.request_id = id;
  made.device = "nobody";
  return made;
}

struct CommandRouterTest : testing::Test {
  CommandRouterTest() {
    BusSpec bus;
    bus.name = "bus";
    bus.port = SerialPortSpec{pty.path()};
    runner = std::make_shared<BusRunner>(io, io.context(), bus, sink);
    router.add("bus", runner);
    runner->start();
  }
  ~CommandRouterTest() override { runner->stop().wait(); }

  std::optional<CommandResult> take(std::uint64_t id, Instant now = steady_now()) {
    if (auto refused = router.deduplicate(command(id), now)) return refused;
    return router.route("bus", command(id), CommandRouter::Identity::kNew, now);
  }

  test::Pty pty;
  test::RecordingSink sink;
  IoThread io{"bus"};
  std::shared_ptr<BusRunner> runner;
  CommandRouter router;
};

TEST_F(CommandRouterTest, ACommandGoesToItsBusAndEndsThere) {
  EXPECT_FALSE(take(1));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(sink.record().results[0].cause, Cause::kUnknownDevice);
}

TEST_F(CommandRouterTest, ADuplicateIsRefusedAndNeverReachesTheBus) {
  EXPECT_FALSE(take(1));
  const auto again = take(1);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->state, CommandState::kRejected);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
  EXPECT_EQ(again->request_id, 1u);
  EXPECT_FALSE(take(2));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 2; }));
  EXPECT_EQ(sink.record().results[1].request_id, 2u);
}

TEST_F(CommandRouterTest, ACommandWithAFreshResultOfAnotherBridgeGetsNoSecondResult) {
  const Instant now = steady_now(), later = now + RecentCommands::kFor;
  EXPECT_TRUE(router.completed_elsewhere("test", 1, now));
  EXPECT_FALSE(router.completed_elsewhere("test", 1, now)) << "it was known";
  EXPECT_TRUE(router.was_completed_elsewhere(command(1), later - std::chrono::milliseconds{1}));
  EXPECT_FALSE(router.was_completed_elsewhere(command(2), now));
  EXPECT_FALSE(router.was_completed_elsewhere(command(1), later));
  const auto again = take(1, later);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
}

TEST_F(CommandRouterTest, ABusThatStopsIsARefusal) {
  router.remove("bus");
  const auto refused = take(1);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->cause, Cause::kShutdown);
}

TEST_F(CommandRouterTest, EveryCommandOfAFloodEndsInOneResult) {
  std::size_t refused = 0;
  constexpr std::size_t kFlood = 20'000;
  for (std::uint64_t id = 1; id <= kFlood; ++id) {
    if (const auto result = take(id)) {
      EXPECT_EQ(result->cause, Cause::kQueueFull);
      ++refused;
    }
  }
  EXPECT_TRUE(sink.wait_for([&](const auto& r) { return r.results.size() == kFlood - refused; }));
}

TEST_F(CommandRouterTest, OnlyAWriteWhoseIdentityIsKeptReachesItsBus) {
  const Instant now = steady_now();
  EXPECT_FALSE(router.deduplicate(command(1), now));
  EXPECT_FALSE(router.deduplicate(command(2), now));
  EXPECT_FALSE(router.route("bus", command(2), CommandRouter::Identity::kNew, now));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(sink.record().results[0].request_id, 2u);
}

TEST_F(CommandRouterTest, AWriteThatWasTakenBeforeOrCannotBeKeptIsRefused) {
  const Instant now = steady_now();
  using Identity = CommandRouter::Identity;
  for (const auto& [identity, cause] : {std::pair{Identity::kKnown, Cause::kDuplicate},
                                        std::pair{Identity::kNotKept, Cause::kOffline},
                                        std::pair{Identity::kNotNoted, Cause::kOffline}}) {
    const auto refused = router.route("bus", command(1), identity, now);
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->state, CommandState::kRejected);
    EXPECT_EQ(refused->cause, cause);
    EXPECT_EQ(refused->request_id, 1u);
  }
  EXPECT_TRUE(sink.record().results.empty());
}

TEST_F(CommandRouterTest, AReadNeedsNoIdentity) {
  Command read = command(1);
  EXPECT_TRUE(CommandRouter::must_be_noted(read));
  read.operation = Operation::kAcquire;
  EXPECT_FALSE(CommandRouter::must_be_noted(read));
}

TEST_F(CommandRouterTest, ALateCommandIsExpiredOnceAndThenADuplicate) {
  const auto late = router.deduplicate(command(1), steady_now(), "late");
  ASSERT_TRUE(late);
  EXPECT_EQ(late->state, CommandState::kExpired);
  EXPECT_EQ(late->reason, "late");
  const auto again = router.deduplicate(command(1), steady_now(), "late");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
}

TEST_F(CommandRouterTest, AWriteWhoseBusStopsMeanwhileIsRefused) {
  EXPECT_FALSE(router.deduplicate(command(1), steady_now()));
  router.remove("bus");
  const auto refused = router.route("bus", command(1), CommandRouter::Identity::kNew, steady_now());
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->cause, Cause::kShutdown);
}

}  // namespace
}  // namespace fieldcast
