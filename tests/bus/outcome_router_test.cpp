#include <gtest/gtest.h>

#include <algorithm>

#include "core/bus/exchange_flow.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

class OutcomeRouterTest : public testing::Test {
 protected:
  static BusSpec bus(bool network) {
    BusSpec bus = test::rtu_bus(1);
    bus.devices[0].retries = 1;
    if (!network) return bus;
    bus.devices[0].protocol = "modbus-tcp";
    bus.port = TcpPortSpec{"10.0.0.7", 502, {}, 3s};
    return bus;
  }
  explicit OutcomeRouterTest(bool network = false) : parts_(bus(network), plain_text_codec()) {
    parts_.channels.start(Instant{});
  }

  void ask(Instant now) { ASSERT_TRUE(arbiter_.next(now)); }
  Instant time_out() {
    const Instant now = parts_.wire().driver().deadline();
    Bytes out;
    EXPECT_EQ(parts_.wire().on_timer(now, out), ExchangeDriver::Outcome::kFailed);
    reopen_ = outcomes_.conclude(false, now, sink_);
    return now;
  }
  void receive(const Bytes& bytes, Instant now) {
    Bytes out;
    const auto outcome = parts_.wire().on_bytes(bytes, now, out);
    ASSERT_NE(outcome, ExchangeDriver::Outcome::kWaiting);
    reopen_ = outcomes_.conclude(outcome == ExchangeDriver::Outcome::kDone, now, sink_);
  }
  template <class Wanted>
  std::size_t count() const {
    return static_cast<std::size_t>(
        std::count_if(actions_.begin(), actions_.end(),
                      [](const Action& action) { return std::holds_alternative<Wanted>(action); }));
  }

  BusParts parts_;
  Arbiter arbiter_{parts_};
  OutcomeRouter outcomes_{parts_, arbiter_};
  std::uint64_t samples_ = 0;
  Actions actions_;
  ActionSink sink_{parts_.setup, samples_, actions_};
  std::optional<Reopen> reopen_;
};

const Bytes kZeros{0x01, 0x03, 0x08, 0, 0, 0, 0, 0, 0, 0, 0, 0x95, 0xD7};
const Bytes kRefusal{0x01, 0x83, 0x02, 0xC0, 0xF1};

TEST_F(OutcomeRouterTest, AResponseBecomesSamples) {
  ask(Instant{});
  receive(kZeros, Instant{50ms});
  EXPECT_EQ(samples_, 4u);
  EXPECT_EQ(outcomes_.causes().total(), 0u);
  EXPECT_EQ(parts_.devices.report(0).state, DeviceState::kOnline);
  EXPECT_FALSE(parts_.wire().waiting());
}

TEST_F(OutcomeRouterTest, AReadIsRepeatedAsOftenAsConfigured) {
  ask(Instant{});
  const Instant failed = time_out();
  EXPECT_TRUE(parts_.wire().waiting());
  EXPECT_EQ(parts_.devices.report(0).failures, 0u) << "a try is no exchange";
  ask(failed + 10ms);
  (void)time_out();
  EXPECT_FALSE(parts_.wire().waiting());
  EXPECT_EQ(outcomes_.causes()[Cause::kNoResponse], 2u);
  EXPECT_EQ(parts_.devices.report(0).failures, 1u);
  EXPECT_EQ(parts_.devices.report(0).retries, 1u);
  EXPECT_FALSE(parts_.late.none_owed());
}

// Some devices do not respond to addresses that they do not have.
TEST_F(OutcomeRouterTest, AGatewaysReadWithoutResponseSaysNothingAboutTheDevice) {
  ask(Instant{});
  receive(kZeros, Instant{50ms});
  parts_.reads.suspend(0, kNever);
  Instant now{100ms};
  for (int i = 0; i < 5; ++i) {
    Command command;
    command.requester = "client";
    command.request_id = static_cast<std::uint64_t>(i);
    command.device = "unit-1";
    command.operation = Operation::kAcquire;
    command.target = AddressTarget{"holding:" + std::to_string(5000 + 10 * i), {}};
    command.count = static_cast<std::uint32_t>(i + 1);
    command.gateway = true;
    parts_.commands.accept(command, {}, now, sink_);
    ask(now);
    now = time_out() + 1s;
    EXPECT_FALSE(parts_.wire().waiting()) << "it is not repeated";
  }
  EXPECT_EQ(count<Complete>(), 5u);
  EXPECT_EQ(parts_.devices.report(0).state, DeviceState::kOnline);
  EXPECT_FALSE(parts_.devices.sick(0));
  EXPECT_EQ(outcomes_.causes()[Cause::kNoResponse], 5u);
  const Request one = ReadRequest{{{test::kHolding, 100, 1}}};
  EXPECT_GT(parts_.devices.longest_exchange(0, one), parts_.setup.device(0).timeout)
      << "the next one may be silent as well";
}

TEST_F(OutcomeRouterTest, ARefusalIsNeverRepeated) {
  ask(Instant{});
  receive(kRefusal, Instant{20ms});
  EXPECT_FALSE(parts_.wire().waiting());
  EXPECT_EQ(outcomes_.causes()[Cause::kDeviceError], 1u);
  EXPECT_EQ(parts_.devices.report(0).failures, 0u) << "it answered";
}

TEST_F(OutcomeRouterTest, AWriteIsNeverRepeatedAndItsCommandDecides) {
  Command command;
  command.device = "unit-1";
  command.target = ChannelTarget{"r0"};
  command.values = {Value{std::uint64_t{7}}};
  parts_.commands.accept(command, {}, Instant{}, sink_);
  ask(Instant{});
  ASSERT_TRUE(parts_.wire().flight().is_command());
  if (std::holds_alternative<ReadRequest>(parts_.wire().flight().asked.request))
    GTEST_FAIL() << "an echo is looked for first";
  (void)time_out();
  EXPECT_FALSE(parts_.wire().waiting());
  EXPECT_TRUE(parts_.commands.keeps_wire()) << "it reads back";
}

TEST_F(OutcomeRouterTest, ALostDeviceMakesItsChannelsFailAndIsNotRead) {
  Instant now{};
  while (!parts_.devices.offline(0) && now < Instant{10s}) {
    ask(now);
    now = time_out() + 700ms;
  }
  EXPECT_TRUE(parts_.devices.offline(0));
  EXPECT_EQ(count<Notice>(), 1u);
  EXPECT_FALSE(parts_.reads.due(now));
  EXPECT_FALSE(reopen_) << "a serial port is not opened anew for that";
}

TEST_F(OutcomeRouterTest, ALateResponseEndsTheRepetition) {
  ask(Instant{});
  const Instant failed = time_out();
  ASSERT_TRUE(parts_.wire().waiting());
  outcomes_.take_late(parts_.late.in_strays(kZeros, failed + 1ms), failed + 1ms, sink_);
  EXPECT_EQ(samples_, 4u);
  EXPECT_FALSE(parts_.wire().waiting());
}

class OutcomeRouterOverNetwork : public OutcomeRouterTest {
 protected:
  OutcomeRouterOverNetwork() : OutcomeRouterTest(true) {}
};

TEST_F(OutcomeRouterOverNetwork, AConnectionBehindWhichNobodyRespondsIsOpenedAgain) {
  Instant now{};
  while (!parts_.devices.offline(0) && now < Instant{10s}) {
    EXPECT_FALSE(reopen_);
    ask(now);
    now = time_out() + 700ms;
  }
  ASSERT_TRUE(reopen_);
  EXPECT_EQ(reopen_->reason, "no device responds");
}

TEST_F(OutcomeRouterOverNetwork, AStreamWhoseFramingIsLostIsOpenedAgain) {
  const Bytes broken{0, 1, 0xFF, 0xFF, 0, 3, 1, 3, 0};
  for (Instant now{}; !reopen_ && now < Instant{10s}; now += 1s) {
    ask(now);
    Bytes out;
    const auto outcome = parts_.wire().on_bytes(broken, now + 20ms, out);
    if (outcome == ExchangeDriver::Outcome::kFailed)
      reopen_ = outcomes_.conclude(false, now + 20ms, sink_);
    else
      (void)time_out();
  }
  ASSERT_TRUE(reopen_);
  EXPECT_EQ(reopen_->reason, "the header of the response is not valid");
}

}  // namespace
}  // namespace fieldcast
