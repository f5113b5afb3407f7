#include <gtest/gtest.h>

#include "core/bus/exchange_flow.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Kind = Flight::Kind;

class ArbiterTest : public testing::Test {
 protected:
  void write(const std::string& channel, const std::string& device = "unit-1") {
    Command command;
    command.request_id = ++sent_;
    command.device = device;
    command.target = ChannelTarget{channel};
    command.values = {Value{std::uint64_t{7}}};
    parts_.commands.accept(command, {}, Instant{}, sink_);
  }
  void read_addresses(std::uint32_t count) {
    Command command;
    command.request_id = ++sent_;
    command.device = "unit-1";
    command.operation = Operation::kAcquire;
    command.target = AddressTarget{"holding:0", {}};
    command.count = count;
    parts_.commands.accept(command, {}, Instant{}, sink_);
  }
  static Reply reply_to(const Request& request) {
    const auto* read = std::get_if<ReadRequest>(&request);
    return test::items(Bytes(read == nullptr ? 0 : 2 * read->ranges.front().count));
  }
  // Returns the kind of the next exchange at `now`, and completes its command.
  std::optional<Kind> next(Instant now) {
    if (!arbiter_.next(now)) return std::nullopt;
    const Flight flight = *parts_.wire().abort();
    if (flight.is_command())
      parts_.commands.responded(flight.batch, reply_to(flight.asked.request), now, now, sink_);
    else if (flight.kind == Kind::kRead)
      parts_.reads.broken_off(flight.block, now);
    last_device_ = flight.asked.device;
    return flight.kind;
  }
  void take_offline(DeviceIndex device, Instant now) {
    for (int i = 0; i < 2; ++i) (void)parts_.devices.failed(device, Cause::kNoResponse, now, sink_);
    arbiter_.suspend(device, now);
  }

  static BusSpec bus() {
    BusSpec spec = test::rtu_bus(2);
    spec.devices.front().allow_raw_read = true;
    return spec;
  }

  BusParts parts_{bus(), plain_text_codec()};
  Arbiter arbiter_{parts_};
  std::uint64_t samples_ = 0;
  std::uint64_t sent_ = 0;
  DeviceIndex last_device_ = 0;  // set by the last next()
  Actions actions_;
  ActionSink sink_{parts_.setup, samples_, actions_};
};

TEST_F(ArbiterTest, NothingIsSentWhileTheWireMustBeSilent) {
  parts_.wire().opened(Instant{1s});
  EXPECT_FALSE(arbiter_.next(Instant{1s}));
  EXPECT_EQ(arbiter_.look_again(), Instant{1s} + parts_.setup.silence());
  EXPECT_TRUE(arbiter_.next(arbiter_.look_again()));
}

TEST_F(ArbiterTest, CommandsAndReadsThatAreDueTakeTurns) {
  write("r0");
  write("r2");  // not adjacent: needs its own request
  write("r0", "unit-2");
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_EQ(next(Instant{}), Kind::kRead);
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_EQ(next(Instant{}), Kind::kRead);
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_EQ(next(Instant{}), Kind::kRead);
}

TEST_F(ArbiterTest, RequestsOfALongReadAndReadsThatAreDueTakeTurns) {
  read_addresses(300);
  for (int request = 0; request < 3; ++request) {
    EXPECT_EQ(next(Instant{}), Kind::kCommand) << request;
    EXPECT_EQ(next(Instant{}), Kind::kRead) << request;
  }
  EXPECT_TRUE(parts_.commands.empty());
}

TEST_F(ArbiterTest, ALongReadOfAPausingDeviceDoesNotKeepTheWire) {
  read_addresses(300);
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_EQ(next(Instant{}), Kind::kRead);
  parts_.devices.busy(0, Instant{});
  const Instant soon = Instant{} + DeviceMonitor::kBusyPause - Arbiter::kLongestWait / 2;
  EXPECT_EQ(next(soon), Kind::kRead);
  EXPECT_EQ(last_device_, 1u);
}

TEST_F(ArbiterTest, WithoutReadsCommandsFollowEachOther) {
  for (DeviceIndex device = 0; device < 2; ++device) parts_.reads.suspend(device, kNever);
  write("r0");
  write("r0", "unit-2");
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_EQ(next(Instant{}), Kind::kCommand);
  EXPECT_FALSE(next(Instant{}));
}

TEST_F(ArbiterTest, AnExchangeThatIsToBeRepeatedGoesFirst) {
  ASSERT_TRUE(arbiter_.next(Instant{}));
  const Instant deadline = parts_.wire().driver().deadline();
  Bytes out;
  (void)parts_.wire().on_timer(deadline, out);
  (void)parts_.wire().conclude(false, deadline);
  parts_.wire().repeat();
  write("r0");
  ASSERT_TRUE(arbiter_.next(deadline + 50ms));
  EXPECT_EQ(parts_.wire().flight().kind, Kind::kRead);
  EXPECT_EQ(parts_.wire().flight().tries, 1u);
}

TEST_F(ArbiterTest, TheWireRestsForACommandThatHasBegun) {
  write("r0");
  ASSERT_TRUE(arbiter_.next(Instant{}));
  (void)parts_.wire().abort();
  parts_.commands.failed(1, Cause::kNoResponse, 0, Instant{}, Instant{}, sink_);
  ASSERT_TRUE(parts_.commands.keeps_wire()) << "it reads back";
  parts_.devices.busy(0, Instant{});
  const Instant begin = Instant{} + DeviceMonitor::kBusyPause;
  EXPECT_EQ(next(Instant{}), Kind::kRead) << "too long to wait";
  EXPECT_FALSE(next(begin - 10ms));
  EXPECT_EQ(arbiter_.look_again(), begin);
  EXPECT_EQ(next(begin), Kind::kCommand);
}

TEST_F(ArbiterTest, AnOfflineDeviceIsProbedBeforeReads) {
  take_offline(0, Instant{});
  EXPECT_EQ(next(Instant{100ms}), Kind::kRead);
  ASSERT_TRUE(arbiter_.next(Instant{31s}));
  EXPECT_EQ(parts_.wire().flight().kind, Kind::kProbe) << "overdue";
  EXPECT_EQ(parts_.wire().flight().asked.device, 0u);
}

TEST_F(ArbiterTest, ASickDeviceIsAdmittedWhenTheTimeHasCome) {
  for (int i = 0; i < 3; ++i)
    parts_.devices.tried({0, Cause::kChecksum, 1s, {}, {}, {}}, Instant{}, sink_);
  parts_.devices.defer_if_sick(0, 100s, Instant{});
  arbiter_.suspend(0, Instant{});
  EXPECT_EQ(next(Instant{}), Kind::kRead);
  EXPECT_EQ(last_device_, 1u);
  EXPECT_EQ(next(Instant{999s}), Kind::kRead);
  EXPECT_EQ(last_device_, 1u);
  parts_.reads.suspend(1, kNever);
  EXPECT_EQ(next(Instant{1000s}), Kind::kRead);
  EXPECT_EQ(last_device_, 0u);
}

TEST_F(ArbiterTest, WithNothingToDoTheWireRestsPermanently) {
  for (DeviceIndex device = 0; device < 2; ++device) parts_.reads.suspend(device, kNever);
  EXPECT_FALSE(next(Instant{5s}));
  EXPECT_EQ(arbiter_.look_again(), kNever);
}

}  // namespace
}  // namespace fieldcast
