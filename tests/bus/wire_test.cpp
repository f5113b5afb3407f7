#include "core/bus/wire/wire.hpp"

#include <gtest/gtest.h>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using Outcome = ExchangeDriver::Outcome;

const Bytes kRequest{0x01, 0x03, 0x00, 0x64, 0x00, 0x01, 0xC5, 0xD5};
const Bytes kAnswer{0x01, 0x03, 0x02, 0x00, 0x2A, 0x39, 0x9B};

class WireTest : public testing::Test {
 protected:
  static Flight read() {
    Flight flight;
    flight.asked.request = ReadRequest{{{test::kHolding, 100, 1}}};
    return flight;
  }
  Bytes send(Instant at) { return wire_.send({{1}, 200ms, 0ms}, at); }

  BusSetup setup_{test::rtu_bus(1)};
  Bytes session_;
  Wire wire_{setup_, session_};
  Bytes out_;
};

TEST(WireEcho, IsKnownIfItIsConfiguredOrThereIsNoLine) {
  const auto echo_of = [](std::optional<bool> configured, const PortSpec& port) {
    BusSpec spec = test::rtu_bus(1);
    spec.echo = configured;
    spec.port = port;
    const BusSetup setup(spec);
    Bytes session;
    return Wire(setup, session).driver().echo();
  };
  const PortSpec line = SerialPortSpec{"/dev/none", {}}, network = TcpPortSpec{.host = "server"};
  EXPECT_EQ(echo_of(true, line), Echo::kPresent);
  EXPECT_EQ(echo_of(false, line), Echo::kAbsent);
  EXPECT_EQ(echo_of({}, line), Echo::kUnknown);
  EXPECT_EQ(echo_of({}, network), Echo::kAbsent);
}

TEST_F(WireTest, AFlightIsSentAcknowledgedAndAccepted) {
  wire_.launch(read());
  EXPECT_TRUE(wire_.waiting());
  EXPECT_FALSE(wire_.exchanging());
  EXPECT_EQ(send(Instant{}), kRequest);
  EXPECT_TRUE(wire_.exchanging());
  EXPECT_FALSE(wire_.waiting());
  ASSERT_EQ(wire_.on_bytes(kAnswer, Instant{20ms}, out_), Outcome::kDone);
  const Wire::Ended ended = wire_.conclude(true, Instant{20ms});
  EXPECT_TRUE(ended.done && ended.responded);
  EXPECT_EQ(ended.exchange->reply()[0].items, (Bytes{0x00, 0x2A}));
  EXPECT_EQ(ended.spent, 20ms + setup_.silence());
  EXPECT_EQ(wire_.take().tries, 0u);
  EXPECT_FALSE(wire_.waiting());
  EXPECT_EQ(wire_.exchanges(), 1u);
}

TEST_F(WireTest, IsSilentAfterAnExchange) {
  wire_.launch(read());
  (void)send(Instant{});
  (void)wire_.on_bytes(kAnswer, Instant{20ms}, out_);
  (void)wire_.conclude(true, Instant{20ms});
  EXPECT_EQ(wire_.free_at(), Instant{20ms} + setup_.silence());
}

TEST_F(WireTest, ARepeatedFlightKeepsItsStartAndHasNoResponse) {
  wire_.launch(read());
  (void)send(Instant{});
  const Instant deadline = wire_.driver().deadline();
  ASSERT_EQ(wire_.on_timer(deadline, out_), Outcome::kFailed);
  const Wire::Ended ended = wire_.conclude(false, deadline);
  EXPECT_EQ(ended.cause, Cause::kNoResponse);
  EXPECT_FALSE(ended.responded);
  wire_.repeat();
  EXPECT_TRUE(wire_.waiting());
  (void)send(Instant{300ms});
  EXPECT_EQ(wire_.flight().started, Instant{});
  EXPECT_EQ(wire_.flight().tries, 1u);
  EXPECT_TRUE(wire_.flight().no_response);
  EXPECT_EQ(wire_.flight().asked.sent_until, Instant{300ms} + setup_.line().characters(8));
  (void)wire_.on_bytes(kAnswer, Instant{330ms}, out_);
  EXPECT_EQ(wire_.conclude(true, Instant{330ms}).spent, ended.spent + 30ms + setup_.silence())
      << "the wire was free between the tries";
}

// The device is not charged for a suspension: it would be paused for ten times its cost.
TEST_F(WireTest, TimeInWhichTheProcessStoodStillIsNotTheDevices) {
  wire_.launch(read());
  (void)send(Instant{});
  const Instant deadline = wire_.driver().deadline();
  ASSERT_EQ(wire_.on_timer(deadline + 4s, out_), Outcome::kFailed);
  const Duration lost = wire_.conclude(false, deadline + 4s).spent;
  EXPECT_EQ(lost, deadline - Instant{} + setup_.silence());
  wire_.repeat();
  (void)send(Instant{8s});
  const Bytes broken{0x01, 0x03, 0x02, 0x00, 0x2A, 0x00, 0x00};
  (void)wire_.on_bytes(broken, Instant{12s}, out_);
  if (wire_.exchanging()) (void)wire_.on_timer(Instant{12s}, out_);
  EXPECT_EQ(wire_.conclude(false, Instant{12s}).spent, 2 * lost) << "also before bytes that waited";
}

TEST_F(WireTest, ARefusalIsAResponse) {
  wire_.launch(read());
  (void)send(Instant{});
  const Bytes refusal{0x01, 0x83, 0x02, 0xC0, 0xF1};
  ASSERT_EQ(wire_.on_bytes(refusal, Instant{20ms}, out_), Outcome::kFailed);
  const Wire::Ended ended = wire_.conclude(false, Instant{20ms});
  EXPECT_FALSE(ended.done);
  EXPECT_TRUE(ended.responded);
  EXPECT_EQ(ended.device_code, 2);
}

TEST_F(WireTest, WaitingOnForgetsTheWrongResponse) {
  wire_.launch(read());
  (void)send(Instant{});
  ASSERT_EQ(wire_.on_bytes(kAnswer, Instant{5ms}, out_), Outcome::kDone);
  wire_.wait_on();
  EXPECT_TRUE(wire_.exchanging());
  EXPECT_TRUE(wire_.driver().received().empty());
  EXPECT_EQ(wire_.on_bytes(kAnswer, Instant{20ms}, out_), Outcome::kDone);
}

TEST_F(WireTest, StrayBytesKeepTheLineSilentForAWhileOnly) {
  const Instant start{1s};
  for (Duration passed{}; passed < 400ms; passed += 1ms) wire_.stray(start + passed);
  EXPECT_LT(wire_.free_at(), start + Wire::kLongestStray + setup_.silence());
  EXPECT_GE(wire_.free_at(), start + Wire::kLongestStray);
}

TEST_F(WireTest, AnAbortedExchangeReturnsItsFlight) {
  EXPECT_FALSE(wire_.abort());
  wire_.launch(read());
  (void)send(Instant{});
  EXPECT_TRUE(wire_.abort());
  EXPECT_FALSE(wire_.exchanging());
  EXPECT_FALSE(wire_.waiting());
}

TEST_F(WireTest, SharesCountWhatIsPending) {
  (void)wire_.shares(Instant{});
  wire_.launch(read());
  (void)send(Instant{500ms});
  const auto shares = wire_.shares(Instant{1s});
  EXPECT_DOUBLE_EQ(shares.busy, 0.5);
  EXPECT_DOUBLE_EQ(shares.reading, 0.5);
}

}  // namespace
}  // namespace fieldcast
