// A Modbus TCP gateway with two units: unit 1 responds, and each request to unit 2 costs the
// connection. In virtual time; a lost connection is opened again after kReopening.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

class LostConnection : public testing::Test {
 protected:
  enum class Fault : std::uint8_t { kNone, kCloses, kInvalidHeader, kInvalidPdu };
  static constexpr Duration kReopening = 100ms;
  static constexpr Duration kResponseTime = 5ms;

  static BusSpec gateway(unsigned in_flight) {
    BusSpec bus = rtu_bus(2);
    bus.port = TcpPortSpec{.host = "127.0.0.1", .port = 502};
    bus.in_flight = in_flight;
    for (DeviceSpec& device : bus.devices) {
      device.protocol = "modbus-tcp";
      device.retries = 0;
      device.timeout = 100ms;
      device.channels.resize(1);
      device.channels[0].refresh = 1s;
    }
    return bus;
  }
  explicit LostConnection(unsigned in_flight = 1) : engine_(gateway(in_flight)) {}

  void feed(const BusEvent& event) {
    Actions actions;
    engine_.on_event(event, now_, actions);
    make_plans(engine_, now_, actions);
    for (const Action& action : actions) {
      if (const auto* send = std::get_if<fieldcast::Send>(&action))
        requests_.push_back(send->bytes);
      if (const auto* notice = std::get_if<Notice>(&action)) notices_.push_back(*notice);
      if (const auto* publish = std::get_if<Publish>(&action)) see(*publish);
      if (std::holds_alternative<Reopen>(action)) lost();
    }
  }
  void see(const Publish& publish) {
    for (const Sample& sample : publish.samples) {
      if (sample.channel != 0) continue;
      if (sample.quality != Quality::kGood) {
        bad_.push_back(sample.quality);
        continue;
      }
      if (last_good_ != kLongAgo) longest_gap_ = std::max(longest_gap_, now_ - last_good_);
      last_good_ = now_;
    }
  }
  void lost() {
    open_at_ = now_ + kReopening;
    requests_.clear();
    ++losses_;
  }
  void run(Duration time) {
    for (const Instant end = now_ + time; now_ < end; now_ += 1ms) {
      if (open_at_ <= now_) {
        open_at_ = kNever;
        feed(Opened{});
      }
      feed(TimerFired{});
      if (now_ - handled_ < kResponseTime || requests_.empty()) continue;
      handled_ = now_;
      const Bytes request = requests_.front();
      requests_.erase(requests_.begin());
      handle(request);
    }
  }
  // The gateway handles one request after the other.
  void handle(const Bytes& request) {
    const Fault fault = request[6] == 2 ? fault_ : Fault::kNone;
    if (request[6] == 2) asked_.push_back(now_);
    Bytes response(request.begin(), request.begin() + 4);
    switch (fault) {
      case Fault::kNone: append(response, Bytes{0, 5, request[6], 3, 2, 0, 7}); break;
      case Fault::kCloses: lost(); return feed(Closed{.reason = "closed by the other side"});
      case Fault::kInvalidHeader:
        response[3] = 9;
        append(response, Bytes{0, 5, request[6], 3, 2, 0, 7});
        break;
      case Fault::kInvalidPdu: append(response, Bytes{0, 7, request[6], 3, 4, 0, 7, 0, 7}); break;
    }
    feed(Received{response});
  }
  [[nodiscard]] DeviceReport unit(DeviceIndex device) const {
    return engine_.device_report(device, now_);
  }

  BusEngine engine_;
  Fault fault_ = Fault::kCloses;
  Instant now_{10s}, open_at_{10s}, handled_{};
  std::vector<Bytes> requests_;
  std::vector<Instant> asked_;  // unit 2
  std::vector<Quality> bad_;    // of the samples of unit 1 that are not good
  std::vector<Notice> notices_;
  Instant last_good_ = kLongAgo;
  Duration longest_gap_{};
  unsigned losses_ = 0;
};

TEST_F(LostConnection, AUnitThatClosesItIsPolledLessAndLessOften) {
  run(60s);
  EXPECT_EQ(unit(0).state, DeviceState::kOnline);
  EXPECT_EQ(unit(0).failures, 0u);
  EXPECT_EQ(unit(1).state, DeviceState::kOffline);
  EXPECT_EQ(unit(1).causes[Cause::kPortClosed], unit(1).failures);
  EXPECT_EQ(unit(1).failures, asked_.size());
  EXPECT_LE(asked_.size(), 9u) << "2 reads, then probes after 0.5, 1, 2, 4 s and so on";
  EXPECT_LE(longest_gap_, 1s + kReopening);
  ASSERT_GE(notices_.size(), 2u);
  EXPECT_EQ(notices_[0].text, "the connection was closed when it was polled");
  EXPECT_EQ(
      notices_[1].text,
      "each request to it costs the connection; polled less and less often until it responds");
}

TEST_F(LostConnection, AUnitThatClosedItIsReadAgainWhenItResponds) {
  run(20s);
  ASSERT_EQ(unit(1).state, DeviceState::kOffline);
  fault_ = Fault::kNone;
  run(DeviceHealth::kLastProbe);
  EXPECT_EQ(unit(1).state, DeviceState::kOnline);
}

TEST_F(LostConnection, AUnitWithInvalidHeadersIsPolledLessAndLessOften) {
  fault_ = Fault::kInvalidHeader;
  run(60s);
  EXPECT_EQ(unit(0).state, DeviceState::kOnline);
  EXPECT_EQ(unit(1).state, DeviceState::kOffline);
  EXPECT_EQ(unit(1).causes[Cause::kMalformed], unit(1).failures);
  EXPECT_LE(asked_.size(), 9u);
  EXPECT_LE(longest_gap_, 1s + kReopening);
}

TEST_F(LostConnection, AWholeFrameWithAnInvalidPduCostsOnlyItsExchange) {
  fault_ = Fault::kInvalidPdu;
  run(60s);
  EXPECT_EQ(losses_, 0u);
  EXPECT_EQ(unit(1).state, DeviceState::kDegraded);
  EXPECT_GT(unit(1).causes[Cause::kMalformed], 0u);
  EXPECT_LE(longest_gap_, 1s);
  EXPECT_TRUE(bad_.empty());
}

TEST_F(LostConnection, EachReopeningIsCounted) {
  for (const Fault fault : {Fault::kCloses, Fault::kInvalidHeader}) {
    fault_ = fault;
    run(10s);
    EXPECT_EQ(engine_.bus_report(now_).reopened, losses_);
  }
  EXPECT_GT(losses_, 2u);
}

// The bridge closed the connection itself, which explains what it does not read meanwhile.
TEST_F(LostConnection, ValuesThatExpireMeanwhileSayWhy) {
  fault_ = Fault::kInvalidHeader;
  while (losses_ == 0) run(1ms);
  open_at_ = kNever;
  bad_.clear();
  run(2s);
  EXPECT_EQ(bad_, std::vector{Quality::kBadNoResponse});
  EXPECT_EQ(engine_.bus_report(now_).misses[Cause::kLate], 0u);
}

TEST_F(LostConnection, AResponseShowsThatTheConnectionWorks) {
  EXPECT_FALSE(engine_.responded_since_opened());
  while (last_good_ == kLongAgo || losses_ == 0) run(1ms);
  run(kReopening - 2ms);
  EXPECT_TRUE(engine_.responded_since_opened()) << "of the last connection";
  run(4ms);
  EXPECT_FALSE(engine_.responded_since_opened());
}

struct LostConnectionInFlight : LostConnection {
  LostConnectionInFlight() : LostConnection(4) {}
};

TEST_F(LostConnectionInFlight, TheOldestRequestIsThatOfTheUnit) {
  for (const Fault fault : {Fault::kCloses, Fault::kInvalidHeader}) {
    fault_ = fault;
    run(60s);
    EXPECT_EQ(unit(0).state, DeviceState::kOnline);
    EXPECT_EQ(unit(0).failures, 0u);
    EXPECT_EQ(unit(1).state, DeviceState::kOffline);
    EXPECT_EQ(engine_.bus_report(now_).reopened, losses_);
  }
  EXPECT_LE(longest_gap_, 1s + kReopening);
}

}  // namespace
}  // namespace fieldcast::test
