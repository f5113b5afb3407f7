#include "bridge/command/command_router.hpp"

#include <gtest/gtest.h>

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
    runner = std::make_shared<BusRunner>(io.context(), io.context(), bus, sink);
    router.add("bus", runner);
    runner->start();
  }
  ~CommandRouterTest() override { runner->stop().wait(); }

  test::Pty pty;
  test::RecordingSink sink;
  IoThread io{"bus"};
  std::shared_ptr<BusRunner> runner;
  CommandRouter router;
};

TEST_F(CommandRouterTest, ACommandGoesToItsBusAndEndsThere) {
  EXPECT_FALSE(router.take("bus", command(1), steady_now()));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(sink.record().results[0].cause, Cause::kUnknownDevice);
}

TEST_F(CommandRouterTest, ADuplicateIsRefusedAndNeverReachesTheBus) {
  EXPECT_FALSE(router.take("bus", command(1), steady_now()));
  const auto again = router.take("bus", command(1), steady_now());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->state, CommandState::kRejected);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
  EXPECT_EQ(again->request_id, 1u);
  EXPECT_FALSE(router.take("bus", command(2), steady_now()));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 2; }));
  EXPECT_EQ(sink.record().results[1].request_id, 2u);
}

TEST_F(CommandRouterTest, ACommandWithAFreshResultOfAnotherBridgeGetsNoSecondResult) {
  const Instant now = steady_now(), later = now + RecentCommands::kFor;
  EXPECT_TRUE(router.answered_elsewhere("test", 1, now));
  EXPECT_FALSE(router.answered_elsewhere("test", 1, now)) << "it was known";
  EXPECT_TRUE(router.was_answered_elsewhere(command(1), later - std::chrono::milliseconds{1}));
  EXPECT_FALSE(router.was_answered_elsewhere(command(2), now));
  EXPECT_FALSE(router.was_answered_elsewhere(command(1), later));
  const auto again = router.take("bus", command(1), later);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
}

TEST_F(CommandRouterTest, ABusThatStopsIsARefusal) {
  router.remove("bus");
  const auto refused = router.take("bus", command(1), steady_now());
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->cause, Cause::kShutdown);
}

TEST_F(CommandRouterTest, EveryCommandOfAFloodEndsInOneResult) {
  std::size_t refused = 0;
  constexpr std::size_t kFlood = 20'000;
  for (std::uint64_t id = 1; id <= kFlood; ++id) {
    if (const auto result = router.take("bus", command(id), steady_now())) {
      EXPECT_EQ(result->cause, Cause::kQueueFull);
      ++refused;
    }
  }
  EXPECT_TRUE(sink.wait_for([&](const auto& r) { return r.results.size() == kFlood - refused; }));
}

// A store of identities, controlled by the test.
struct Keeper {
  explicit Keeper(CommandRouter& router) {
    router.keep_identities(
        [this](const std::string&, const std::string&, std::uint64_t id, auto kept) {
          waiting[id] = kept;
        },
        [this](const std::string&, const CommandResult& result) { refused.push_back(result); });
  }
  std::map<std::uint64_t, std::function<void(CommandRouter::Identity)>> waiting;
  std::vector<CommandResult> refused;
};

TEST_F(CommandRouterTest, AWriteWaitsUntilItsIdentityIsKept) {
  Keeper keeper(router);
  EXPECT_FALSE(router.take("bus", command(1), steady_now()));
  EXPECT_FALSE(router.take("bus", command(2), steady_now()));
  ASSERT_EQ(keeper.waiting.size(), 2u);
  keeper.waiting[2](CommandRouter::Identity::kNew);
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(sink.record().results[0].request_id, 2u);
  EXPECT_TRUE(keeper.refused.empty());
}

TEST_F(CommandRouterTest, AWriteThatWasTakenBeforeOrCannotBeKeptIsRefused) {
  Keeper keeper(router);
  EXPECT_FALSE(router.take("bus", command(1), steady_now()));
  EXPECT_FALSE(router.take("bus", command(2), steady_now()));
  keeper.waiting[1](CommandRouter::Identity::kKnown);
  keeper.waiting[2](CommandRouter::Identity::kNotKept);
  ASSERT_EQ(keeper.refused.size(), 2u);
  EXPECT_EQ(keeper.refused[0].cause, Cause::kDuplicate);
  EXPECT_EQ(keeper.refused[0].request_id, 1u);
  EXPECT_EQ(keeper.refused[1].cause, Cause::kOffline);
  EXPECT_TRUE(sink.record().results.empty());
}

TEST_F(CommandRouterTest, AWriteWhoseBusStopsMeanwhileIsRefused) {
  Keeper keeper(router);
  EXPECT_FALSE(router.take("bus", command(1), steady_now()));
  router.remove("bus");
  keeper.waiting[1](CommandRouter::Identity::kNew);
  ASSERT_EQ(keeper.refused.size(), 1u);
  EXPECT_EQ(keeper.refused[0].cause, Cause::kShutdown);
}

TEST_F(CommandRouterTest, AReadNeedsNoIdentity) {
  Keeper keeper(router);
  Command read = command(1);
  read.operation = Operation::kAcquire;
  EXPECT_FALSE(router.take("bus", read, steady_now()));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_TRUE(keeper.waiting.empty());
}

}  // namespace
}  // namespace fieldcast
