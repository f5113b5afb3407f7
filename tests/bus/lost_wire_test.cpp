// Tests an engine that loses its wire to another master (`fence: listen`): it must not accept the
// responses to the other master.
#include <gtest/gtest.h>

#include <optional>
#include <string_view>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

class LostWire : public testing::Test {
 protected:
  static BusSpec fenced() {
    BusSpec spec = rtu_bus(1);
    std::get<SerialPortSpec>(spec.port).fence.kind = Fence::kListen;
    spec.devices[0].protocol = "modbus-ascii";
    spec.devices[0].retries = 0;
    return spec;
  }
  // Longer than one exchange at 19200 baud.
  static constexpr Duration kExchange = 60ms;
  static Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }
  std::optional<Bytes> feed(const BusEvent& event) {
    std::optional<Bytes> sent;
    Actions actions;
    engine_.on_event(event, now_, actions);
    make_plans(engine_, now_, actions);
    for (const Action& action : actions) {
      if (const auto* send = std::get_if<Send>(&action)) sent = send->bytes;
      if (const auto* publish = std::get_if<Publish>(&action)) {
        for (const Sample& sample : publish->samples) good_ += sample.quality == Quality::kGood;
      }
    }
    return sent;
  }
  Bytes ask() {
    (void)feed(Opened{});
    for (;;) {
      now_ += 1ms;
      if (auto sent = feed(TimerFired{})) return *sent;
    }
  }

  const BusSpec spec_ = fenced();
  const FenceTimes times_ = fence_times(spec_);
  // Unit 1, four registers of value 7 (Modbus over Serial Line V1.02, 2.5.2; LRC is 100h - 28h).
  const Bytes answer_ = bytes_of(":0103080007000700070007D8\r\n");
  BusEngine engine_{spec_};
  Instant now_{10s};
  int good_ = 0;
};

TEST_F(LostWire, AResponseInTimeIsTaken) {
  (void)ask();
  now_ += kExchange;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 4);
}

// The process was suspended so long that another master may have started an exchange.
TEST_F(LostWire, AResponseAfterALongStandstillMayBeAnotherMasters) {
  (void)ask();
  now_ += times_.claim + 50ms;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 0);
}

// Both masters started at the same time, and the second one receives its response first.
TEST_F(LostWire, AFirstResponseThatBeganBeforeTheRequestHadEndedIsAnotherMasters) {
  (void)ask();
  now_ += 1ms;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 0);
  now_ += kExchange;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 4);
}

// Simulates a port that is not a real serial line.
TEST_F(LostWire, ResponsesThatAlwaysComeTooEarlyAreTakenFromTheSecondOn) {
  (void)ask();
  now_ += 1ms;
  (void)feed(Received{answer_});
  for (int i = 0; i < 1000 && good_ == 0; ++i) {
    now_ += 1ms;
    if (!feed(TimerFired{})) continue;
    now_ += 1ms;
    (void)feed(Received{answer_});
  }
  EXPECT_EQ(good_, 4);
}

// Both masters started at the same time, and the request of this one was garbled.
TEST_F(LostWire, AResponseBehindARequestOfAnotherMasterIsNotTaken) {
  (void)ask();
  now_ += 20ms;
  (void)feed(Received{bytes_of(":010300C8000430\r\n")});
  EXPECT_FALSE(engine_.bus_report(now_).listening);
  now_ += kExchange;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 0);
  EXPECT_TRUE(engine_.bus_report(now_).listening);
}

TEST_F(LostWire, AResponseBehindNoiseIsTaken) {
  (void)ask();
  now_ += kExchange;
  (void)feed(Received{bytes_of("noise:0103\r\n")});
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 4);
  EXPECT_FALSE(engine_.bus_report(now_).listening);
}

// The response is still pending when another master sends the same request.
TEST_F(LostWire, AResponseToAnotherMasterIsNotALateOne) {
  const Bytes request = ask();
  now_ += times_.claim + 50ms;
  (void)feed(TimerFired{});
  (void)feed(Received{request});
  EXPECT_TRUE(engine_.bus_report(now_).listening);
  now_ += 100ms;
  (void)feed(Received{answer_});
  EXPECT_EQ(good_, 0);
}

}  // namespace
}  // namespace fieldcast::test
