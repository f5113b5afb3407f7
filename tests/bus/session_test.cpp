// Tests the greeting of a connection (ExchangeContext::session) with the engine: once for each
// time that the port opens.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Two PLCs at one FINS/TCP port; frames as in fins_tcp_test.cpp.
class Session : public testing::Test {
 protected:
  static BusSpec fins_bus() {
    BusSpec spec = rtu_bus(2);
    spec.port = TcpPortSpec{.host = "127.0.0.1", .port = 9600};
    for (DeviceSpec& device : spec.devices) {
      device.protocol = "omron-fins";
      device.retries = 0;
      for (ChannelSpec& channel : device.channels) {
        channel.at = "DM100";
        channel.range = {4, 100, 1};
      }
    }
    return spec;
  }
  void feed(const BusEvent& event) {
    Actions actions;
    engine_.on_event(event, now_, actions);
    make_plans(engine_, now_, actions);
    for (const Action& action : actions) {
      if (const auto* send = std::get_if<fieldcast::Send>(&action)) sent_.push_back(send->bytes);
      reopened_ = reopened_ || std::holds_alternative<Reopen>(action);
    }
  }
  // Runs until the engine has sent so many frames altogether.
  void run_until(std::size_t frames) {
    for (int i = 0; i < 10'000 && sent_.size() < frames; ++i) {
      now_ += 1ms;
      feed(TimerFired{});
    }
    ASSERT_EQ(sent_.size(), frames);
  }
  void respond(const Bytes& bytes) { feed(Received{bytes}); }
  // The last sent frame was a FINS message: exchanges its source and destination.
  void respond_with_value() {
    const Bytes& sent = sent_.back();
    Bytes message(sent.begin() + 16, sent.begin() + 28);
    message[0] = 0xC0;
    std::swap_ranges(message.begin() + 3, message.begin() + 6, message.begin() + 6);
    message.insert(message.end(), {0, 0, 0x12, 0x34});
    Bytes frame{'F', 'I', 'N', 'S'};
    append_u32(frame, static_cast<std::uint32_t>(8 + message.size()));
    append_u32(frame, 2);
    append_u32(frame, 0);
    append(frame, message);
    respond(frame);
  }
  [[nodiscard]] std::ptrdiff_t greetings() const {
    return std::ranges::count_if(sent_, [](const Bytes& frame) { return read_u32(frame, 8) == 0; });
  }
  static Bytes nodes() {
    Bytes frame{'F', 'I', 'N', 'S'};
    for (const std::uint32_t word : {16u, 1u, 0u, 0xEFu, 1u}) append_u32(frame, word);
    return frame;
  }

  BusEngine engine_{fins_bus()};
  Instant now_{10s};
  std::vector<Bytes> sent_;
  bool reopened_ = false;
};

TEST_F(Session, DevicesOfAConnectionShareItsGreeting) {
  feed(Opened{});
  run_until(1);
  EXPECT_EQ(greetings(), 1);
  respond(nodes());
  for (std::size_t frames = 2; frames < 8; ++frames) {
    run_until(frames);
    respond_with_value();
  }
  EXPECT_EQ(greetings(), 1);
}

TEST_F(Session, ANewConnectionSendsTheGreetingAgain) {
  feed(Opened{});
  run_until(1);
  respond(nodes());
  run_until(2);
  respond_with_value();
  feed(Closed{.reason = "connection reset"});
  feed(Opened{});
  run_until(3);
  EXPECT_EQ(greetings(), 2);
}

// The PLC has assigned nodes, but its response was lost, so that it refuses the next greeting.
TEST_F(Session, ALostGreetingOpensTheConnectionAgain) {
  feed(Opened{});
  run_until(2);
  EXPECT_EQ(greetings(), 2);
  EXPECT_FALSE(reopened_);
  Bytes refused{'F', 'I', 'N', 'S'};
  for (const std::uint32_t word : {8u, 1u, 0x21u}) append_u32(refused, word);
  respond(refused);
  EXPECT_TRUE(reopened_);
}

}  // namespace
}  // namespace fieldcast::test
