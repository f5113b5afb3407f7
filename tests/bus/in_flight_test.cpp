// Several requests in flight on a connection: a Modbus TCP device that responds in any
// order.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <random>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

TEST(FlightLimitTest, TheFirstExchangeOfAConnectionIsAlone) {
  FlightLimit limit(4);
  EXPECT_EQ(limit.now(), 1u);
  limit.responded();
  EXPECT_EQ(limit.now(), 4u);
  limit.opened();
  EXPECT_EQ(limit.now(), 1u);
}

TEST(FlightLimitTest, IsHalvedWhenRequestsAreDroppedAndGrowsAgain) {
  FlightLimit limit(8);
  limit.responded();
  for (int i = 0; i < 4; ++i) limit.missed();
  EXPECT_EQ(limit.now(), 4u);
  EXPECT_EQ(limit.planned(10ms), 20ms) << "the plan divides it by 8";
  for (unsigned i = 0; i < FlightLimit::kEnoughResponses; ++i) limit.responded();
  EXPECT_EQ(limit.now(), 5u);
}

TEST(FlightLimitTest, ResponsesLostNowAndThenChangeNothing) {
  FlightLimit limit(8);
  for (int i = 0; i < 10'000; ++i) i % 20 == 0 ? limit.missed() : limit.responded();
  EXPECT_EQ(limit.now(), 8u);
}

// Holding register n has the value n. The device needs `response_time` for each request, and
// handles them at the same time.
class InFlightBus : public testing::Test {
 protected:
  static constexpr unsigned kMost = 4;
  static constexpr std::uint32_t kRegisters = 40;
  static constexpr std::uint16_t kIgnored = 60002;

  explicit InFlightBus(unsigned in_flight = kMost) : InFlightBus(spec(in_flight)) {}
  explicit InFlightBus(const BusSpec& spec) : engine_(spec) {}

  static BusSpec spec(unsigned in_flight) {
    BusSpec spec = rtu_bus(1);
    spec.port = TcpPortSpec{.host = "127.0.0.1", .port = 502};
    spec.in_flight = in_flight;
    DeviceSpec& device = spec.devices.front();
    device.protocol = "modbus-tcp";
    device.retries = 0;
    device.timeout = 100ms;
    const ChannelSpec one = device.channels.front();
    device.channels.clear();
    for (std::uint32_t i = 0; i < kRegisters; ++i) {
      ChannelSpec channel = one;
      channel.name = "r" + std::to_string(i);
      channel.range = {kHolding, i * 1000, 1};
      channel.mode = Mode::kIntensive;
      channel.refresh = 1s;
      device.channels.push_back(channel);
    }
    return spec;
  }

  void feed(const BusEvent& event) {
    Actions actions;
    engine_.on_event(event, now_, actions);
    make_plans(engine_, now_, actions);
    std::vector<Bytes> not_sent;
    for (const Action& action : actions) {
      if (const auto* send = std::get_if<fieldcast::Send>(&action))
        may_send_ ? take(send->bytes) : not_sent.push_back(send->bytes);
      if (const auto* publish = std::get_if<Publish>(&action)) {
        for (const Sample& sample : publish->samples) check(sample);
      }
      if (const auto* complete = std::get_if<Complete>(&action))
        results_.push_back(complete->result);
      reopened_ = reopened_ || std::holds_alternative<Reopen>(action);
    }
    for (const Bytes& bytes : not_sent) feed(NotSent{bytes});
  }
  void take(const Bytes& request) {
    if (late_ == 0) { EXPECT_LE(waiting_.size() + 1, kMost); }
    most_ = std::max(most_, waiting_.size() + 1);
    ++requests_;
    const bool write = request[7] != 3;
    if (write) {
      EXPECT_TRUE(waiting_.empty()) << "a write is alone";
      writing_ = true;
    }
    EXPECT_TRUE(write || !writing_) << "nothing is sent until the write has ended";
    if (drops_ > 0 && requests_ % drops_ == 0) return;
    if (one_at_a_time_ && !waiting_.empty()) return;
    if (read_u16(request, 8) == kIgnored) return;
    Bytes response(request.begin(), request.begin() + 4);
    Bytes pdu(request.begin() + 7, request.begin() + 12);
    if (write) {
      wrote(read_u16(request, 8), read_u16(request, 10));
    } else {
      pdu = {3, 2};
      append_u16(pdu, value_of(read_u16(request, 8)));
    }
    append_u16(response, static_cast<std::uint16_t>(pdu.size() + 1));
    response.push_back(request[6]);
    append(response, pdu);
    const bool late = late_ > 0 && requests_ % late_ == 0;
    waiting_.emplace_back(now_ + (late ? kLate : response_time_), response);
  }
  virtual std::uint16_t value_of(std::uint16_t address) { return address; }
  virtual void wrote(std::uint16_t, std::uint16_t) {}
  void check(const Sample& sample) {
    if (sample.quality != Quality::kGood) return;
    EXPECT_EQ(sample.value, Value{std::uint64_t{sample.channel} * 1000});
    ++good_;
  }
  void run(Duration time) {
    for (const Instant until = now_ + time; now_ < until; now_ += 100us) {
      Bytes stream;
      if (shuffled_) std::ranges::shuffle(waiting_, random_);
      for (std::size_t i = 0; i < waiting_.size();) {
        if (waiting_[i].first > now_) {
          ++i;
          continue;
        }
        append(stream, waiting_[i].second);
        writing_ = writing_ && waiting_[i].second[7] == 3;
        waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
      }
      for (std::size_t at = 0; at < stream.size(); at += piece_)
        feed(Received{ByteView(stream).subspan(at, std::min(piece_, stream.size() - at))});
      feed(TimerFired{});
    }
  }

  // All waiting responses, without any time since their requests.
  void respond_at_once() {
    const auto waiting = std::exchange(waiting_, {});
    for (const auto& [due, response] : waiting) feed(Received{response});
  }

  BusEngine engine_;
  Instant now_{10s};
  Duration response_time_ = 4ms;
  bool shuffled_ = false;
  std::size_t piece_ = 7;
  bool may_send_ = true;
  bool one_at_a_time_ = false;  // drops requests that arrive meanwhile
  unsigned drops_ = 0;          // each n-th request; 0: none
  unsigned late_ = 0;           // response to each n-th request; 0: none
  static constexpr Duration kLate = 130ms;
  std::mt19937 random_{1};
  std::vector<std::pair<Instant, Bytes>> waiting_;
  std::vector<CommandResult> results_;
  std::size_t most_ = 0;
  unsigned requests_ = 0;
  std::uint64_t good_ = 0;
  bool writing_ = false, reopened_ = false;
};

TEST_F(InFlightBus, ReadsAsManyTimesAsOftenAsOneAtATime) {
  feed(Opened{});
  run(1s);
  EXPECT_EQ(most_, kMost);
  EXPECT_GT(good_, 4u * 1000 / 5) << "4 ms each, four at a time, and 0.1 ms until it is sent";
}

// As of a master that has lost its lease.
TEST_F(InFlightBus, RequestsThatWereNotSentAreNotAwaited) {
  feed(Opened{});
  run(50ms);
  may_send_ = false;
  run(1s);
  EXPECT_FALSE(engine_.exchanging());
  const DeviceReport device = engine_.device_report(0, now_);
  EXPECT_EQ(device.state, DeviceState::kOnline);
  EXPECT_EQ(device.failures, 0u);
  may_send_ = true;
  const std::uint64_t before = good_;
  run(50ms);
  EXPECT_GT(good_, before + 20);
}

TEST_F(InFlightBus, ResponsesInAnyOrderBelongToTheirRequests) {
  shuffled_ = true;
  for (const std::size_t piece : {1, 3, 50}) {
    piece_ = piece;
    waiting_.clear();
    feed(Opened{});
    run(500ms);
  }
  EXPECT_GT(good_, 1000u);
}

TEST_F(InFlightBus, ALostResponseCostsOnlyItsExchange) {
  drops_ = 100;
  feed(Opened{});
  run(2s);
  EXPECT_GT(good_, 1000u);
  EXPECT_FALSE(reopened_);
}

TEST_F(InFlightBus, ADeviceThatDropsRequestsGetsThemOneAtATime) {
  one_at_a_time_ = true;
  feed(Opened{});
  run(1s);
  const std::uint64_t before = good_;
  run(500ms);
  EXPECT_GT(good_, before + 100);
  EXPECT_FALSE(reopened_);
}

TEST_F(InFlightBus, ACommandIsAlone) {
  feed(Opened{});
  run(50ms);
  Command command;
  command.requester = "mes";
  command.request_id = 1;
  command.device = "unit-1";
  command.target = ChannelTarget{"r3"};
  command.values = {std::uint64_t{3000}};
  feed(CommandArrived{command});
  run(50ms);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].state, CommandState::kDone);
  const std::uint64_t before = good_;
  run(50ms);
  EXPECT_GT(good_, before + 20);
}

TEST_F(InFlightBus, AStreamWithoutHeaderIsOpenedAgain) {
  feed(Opened{});
  run(20ms);
  feed(Received{Bytes{1, 2, 3, 4, 5, 6, 7}});
  EXPECT_TRUE(reopened_);
  feed(Closed{.reason = "opened again"});
  waiting_.clear();
  feed(Opened{});
  const std::uint64_t before = good_;
  run(50ms);
  EXPECT_GT(good_, before + 20);
}

TEST_F(InFlightBus, BytesOfAClosedConnectionAreIgnored) {
  feed(Opened{});
  run(20ms);
  ASSERT_FALSE(waiting_.empty());
  feed(Closed{.reason = "closed by the other side"});
  const std::uint64_t before = good_;
  respond_at_once();
  EXPECT_EQ(good_, before);
}

struct DatagramBus : InFlightBus {
  DatagramBus() : InFlightBus(over_udp()) {}
  static BusSpec over_udp() {
    BusSpec spec = InFlightBus::spec(1);
    std::get<TcpPortSpec>(spec.port).datagrams = true;
    return spec;
  }
};

TEST_F(DatagramBus, ADatagramOfAnotherExchangeCostsNothing) {
  piece_ = 100;
  feed(Opened{});
  run(500ms);
  EXPECT_GT(good_, 100u);
  const std::uint64_t before = good_;
  feed(Received{Bytes{0x77, 0x77, 0, 0, 0, 5, 1, 3, 2, 0, 9}});
  EXPECT_FALSE(reopened_);
  run(50ms);
  EXPECT_GT(good_, before + 10);
}

// Clients of a gateway read the device's clock and a register that they also write.
class GatewayInFlight : public InFlightBus {
 protected:
  static constexpr std::uint16_t kClock = 60000, kSetpoint = 60001;
  static constexpr Duration kRefresh = 100ms;

  GatewayInFlight() : InFlightBus(with_gateway()) {}
  static BusSpec with_gateway() {
    BusSpec bus = spec(kMost);
    bus.gateway.emplace();
    bus.devices[0].allow_raw_write = true;
    for (ChannelSpec& channel : bus.devices[0].channels) {
      channel.mode = Mode::kScheduled;
      channel.refresh = kRefresh;
    }
    return bus;
  }
  [[nodiscard]] std::uint16_t clock() const {
    return static_cast<std::uint16_t>(now_.time_since_epoch() / 1ms);
  }
  std::uint16_t value_of(std::uint16_t address) override {
    return address == kClock ? clock() : address == kSetpoint ? setpoint_ : address;
  }
  void wrote(std::uint16_t address, std::uint16_t value) override {
    EXPECT_EQ(address, kSetpoint);
    setpoint_ = value;
  }
  void request(unsigned client, std::uint16_t address, std::optional<std::uint16_t> value = {}) {
    Command command;
    command.requester = "gateway " + std::to_string(client);
    command.request_id = ++last_id_;
    command.device = "unit-1";
    command.operation = value ? Operation::kWrite : Operation::kAcquire;
    command.target =
        AddressTarget{"holding:" + std::to_string(address), {.type = ValueType::kUint16}};
    if (value) command.values = {std::uint64_t{*value}};
    command.gateway = true;
    command.expires = now_ + 1s;
    begun_[last_id_] = clock();
    feed(CommandArrived{command});
  }
  // Each of eight clients reads the clock every 20 ms.
  void run_clients(Duration time) {
    for (const Instant until = now_ + time; now_ < until;) {
      for (unsigned client = 0; client < 8; ++client) {
        request(client, kClock);
        run(2500us);
      }
    }
    run(2s);
  }
  std::uint64_t done() const {
    std::uint64_t done = 0;
    for (const CommandResult& result : results_) {
      if (result.state != CommandState::kDone) continue;
      ++done;
      EXPECT_GE(std::get<std::uint64_t>(result.values.at(0)), begun_.at(result.request_id))
          << "a response to an earlier request";
    }
    return done;
  }

  std::uint16_t setpoint_ = 0;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, std::uint16_t> begun_;
};

TEST_F(GatewayInFlight, ClientsReadBesideThePlanWhichKeepsItsRefreshes) {
  feed(Opened{});
  run(1s);
  const std::uint64_t missed = engine_.bus_report(now_).deadline_misses;
  run_clients(3s);
  EXPECT_EQ(results_.size(), last_id_) << "one result for each";
  EXPECT_GT(done(), last_id_ * 9 / 10);
  EXPECT_EQ(engine_.bus_report(now_).deadline_misses, missed);
  EXPECT_GT(most_, 1u);
}

TEST_F(GatewayInFlight, LateResponsesAreNoValuesOfLaterRequests) {
  late_ = 50;
  shuffled_ = true;
  feed(Opened{});
  run(1s);
  run_clients(5s);
  EXPECT_EQ(results_.size(), last_id_);
  EXPECT_GT(done(), last_id_ / 4);
  EXPECT_FALSE(reopened_);
}

TEST_F(GatewayInFlight, ReadsThatTheDeviceIgnoresTakeNoPlaceFromThePlan) {
  feed(Opened{});
  run(1s);
  for (unsigned client = 0; client < 30; ++client) {
    request(client, kIgnored);
    run(110ms);
  }
  most_ = 0;
  run(1s);
  EXPECT_EQ(most_, kMost);
}

TEST_F(GatewayInFlight, AReadAfterAWriteHasItsValue) {
  feed(Opened{});
  run(1s);
  for (std::uint16_t value = 1; value <= 200; ++value) {
    for (unsigned client = 0; client < 3; ++client) request(client, kClock);
    request(3, kSetpoint, value);
    request(4, kSetpoint);
    run(60ms);
    request(4, kSetpoint);
    run(60ms);
    ASSERT_EQ(results_.back().request_id, last_id_);
    ASSERT_EQ(results_.back().state, CommandState::kDone) << results_.back().reason;
    EXPECT_EQ(results_.back().values, std::vector<Value>{Value{std::uint64_t{value}}});
  }
  EXPECT_EQ(results_.size(), last_id_);
}

struct OneInFlightBus : InFlightBus {
  OneInFlightBus() : InFlightBus(1) {}
};

// The time of bytes on a network is not that of a line.
TEST_F(OneInFlightBus, AResponseThatComesEarlierThanEverBeforeIsTheResponse) {
  feed(Opened{});
  run(1s);
  const std::uint64_t before = good_;
  for (int i = 0; i < 400; ++i) {
    respond_at_once();
    now_ += 1us;
    feed(TimerFired{});  // sends, if the bytes have left a line of 100 Mbit/s
  }
  EXPECT_GT(good_, before + 100);
}

TEST_F(OneInFlightBus, AFrameHasEndedWhenNoResponseIsAwaited) {
  feed(Opened{});
  run(20ms);
  ASSERT_TRUE(engine_.exchanging());
  EXPECT_FALSE(engine_.frame_ended());
  feed(StopRequested{});
  EXPECT_TRUE(engine_.frame_ended());
}

TEST_F(InFlightBus, AFrameHasEndedWithItsLastByte) {
  feed(Opened{});
  run(20ms);
  ASSERT_FALSE(waiting_.empty());
  EXPECT_TRUE(engine_.frame_ended());
  const Bytes response = waiting_.front().second;
  waiting_.erase(waiting_.begin());
  feed(Received{ByteView(response).first(5)});
  EXPECT_FALSE(engine_.frame_ended());
  feed(Received{ByteView(response).subspan(5)});
  EXPECT_TRUE(engine_.frame_ended());
}

struct TwoInFlightBus : InFlightBus {
  TwoInFlightBus() : InFlightBus(2) {}
};

TEST_F(TwoInFlightBus, BytesAreDeliveredAsTheyArrive) {
  feed(Opened{});
  run(1s);
  for (int i = 0; i < 50; ++i) {
    run(500us);
    EXPECT_TRUE(engine_.exchanging());
    EXPECT_EQ(engine_.quiet_until(), kLongAgo);
  }
}

TEST_F(InFlightBus, AStopLeavesNoExchange) {
  feed(Opened{});
  run(20ms);
  EXPECT_TRUE(engine_.exchanging());
  feed(StopRequested{});
  EXPECT_FALSE(engine_.exchanging());
}

TEST_F(InFlightBus, TheRequestOfEachFrameIsKnown) {
  feed(Opened{});
  run(10ms);
  Bytes sent = waiting_.front().second;
  EXPECT_EQ(engine_.request_text(sent), "") << "a response";
  EXPECT_EQ(engine_.asked_device(sent), std::nullopt);
}

}  // namespace
}  // namespace fieldcast::test
