#include "bridge/command_desk.hpp"

#include <gtest/gtest.h>

#include "bridge/clock.hpp"
#include "bridge/io_thread.hpp"
#include "tests/bridge/support/pty.hpp"
#include "tests/bridge/support/recording_outlet.hpp"

namespace fieldcast {
namespace {

Command command(std::uint64_t id) {
  Command made;
  made.requester = "test";
  made.request_id = id;
  made.device = "nobody";
  return made;
}

struct CommandDeskTest : testing::Test {
  CommandDeskTest() {
    BusSpec bus;
    bus.name = "bus";
    bus.port = SerialPortSpec{pty.path()};
    runner = std::make_shared<BusRunner>(io.context(), io.context(), bus, outlet);
    desk.add("bus", runner);
    runner->start();
  }
  ~CommandDeskTest() override { runner->stop().wait(); }

  test::Pty pty;
  test::RecordingOutlet outlet;
  IoThread io{"bus"};
  std::shared_ptr<BusRunner> runner;
  CommandDesk desk;
};

TEST_F(CommandDeskTest, ACommandGoesToItsBusAndEndsThere) {
  EXPECT_FALSE(desk.take("bus", command(1), steady_now()));
  ASSERT_TRUE(outlet.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(outlet.record().results[0].cause, Cause::kUnknownDevice);
}

TEST_F(CommandDeskTest, ADuplicateIsRefusedAndNeverReachesTheBus) {
  EXPECT_FALSE(desk.take("bus", command(1), steady_now()));
  const auto again = desk.take("bus", command(1), steady_now());
  ASSERT_TRUE(again);
  EXPECT_EQ(again->state, CommandState::kRejected);
  EXPECT_EQ(again->cause, Cause::kDuplicate);
  EXPECT_EQ(again->request_id, 1u);
  EXPECT_FALSE(desk.take("bus", command(2), steady_now()));
  ASSERT_TRUE(outlet.wait_for([](const auto& r) { return r.results.size() == 2; }));
  EXPECT_EQ(outlet.record().results[1].request_id, 2u);
}

TEST_F(CommandDeskTest, ABusThatStopsIsARefusal) {
  desk.remove("bus");
  const auto refused = desk.take("bus", command(1), steady_now());
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->cause, Cause::kShutdown);
}

TEST_F(CommandDeskTest, EveryCommandOfAFloodEndsInOneResult) {
  std::size_t refused = 0;
  constexpr std::size_t kFlood = 20'000;
  for (std::uint64_t id = 1; id <= kFlood; ++id) {
    if (const auto result = desk.take("bus", command(id), steady_now())) {
      EXPECT_EQ(result->cause, Cause::kQueueFull);
      ++refused;
    }
  }
  EXPECT_TRUE(outlet.wait_for([&](const auto& r) { return r.results.size() == kFlood - refused; }));
}

}  // namespace
}  // namespace fieldcast
