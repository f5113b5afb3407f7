// What a bus does with an event that comes at the wrong time, and the texts of its requests.
#include "core/bus/bus_engine.hpp"

#include <gtest/gtest.h>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

class BusEngineTest : public testing::Test {
 protected:
  static BusSpec bus() {
    BusSpec spec = rtu_bus(1);
    spec.echo = false;
    spec.devices[0].allow_raw_write = true;
    return spec;
  }
  Actions feed(const BusEvent& event) {
    Actions actions;
    engine_.on_event(event, now_, actions);
    make_plans(engine_, now_, actions);
    return actions;
  }
  // The bytes of the next request.
  Bytes sent_after(const BusEvent& event) {
    Actions actions = feed(event);
    for (int i = 0; i < 1000; ++i, now_ += 1ms, actions = feed(TimerFired{})) {
      for (const Action& action : actions) {
        if (const auto* send = std::get_if<fieldcast::Send>(&action)) return send->bytes;
      }
    }
    return {};
  }
  static Command write(Target target, std::uint64_t value) {
    Command command;
    command.request_id = value;
    command.requester = "mes";
    command.device = "unit-1";
    command.target = std::move(target);
    command.values = {Value{value}};
    return command;
  }
  BusState state() { return engine_.bus_report(now_).state; }

  BusEngine engine_{bus()};
  Instant now_{10s};
};

TEST_F(BusEngineTest, NothingHappensAfterAStop) {
  const Bytes request = sent_after(Opened{});
  feed(StopRequested{});
  const BusEvent events[] = {Opened{},     Closed{},         Received{request}, LeaseBegan{},
                             LeaseEnded{}, NotSent{request}, TimerFired{},      CountAbove{99}};
  for (const BusEvent& event : events) {
    now_ += 1s;
    EXPECT_TRUE(feed(event).empty()) << event.index();
    EXPECT_EQ(state(), BusState::kStopped) << event.index();
  }
}

TEST_F(BusEngineTest, TheEndOfALeaseThatNeverBeganChangesNothing) {
  const Bytes request = sent_after(Opened{});
  EXPECT_TRUE(feed(LeaseEnded{}).empty());
  EXPECT_EQ(engine_.asked_device(request), DeviceIndex{0}) << "its response is still awaited";
}

TEST_F(BusEngineTest, BytesThatNoExchangeSentWereNotWithheld) {
  const Bytes request = sent_after(Opened{});
  EXPECT_TRUE(feed(NotSent{Bytes{1, 2, 3}}).empty());
  EXPECT_EQ(engine_.asked_device(request), DeviceIndex{0});
  EXPECT_EQ(engine_.asked_device(Bytes{1, 2, 3}), std::nullopt);
}

TEST_F(BusEngineTest, ALeaseBreaksOffARead) {
  const Bytes request = sent_after(Opened{});
  for (const Action& action : feed(LeaseBegan{}))
    EXPECT_FALSE(std::holds_alternative<Complete>(action));
  EXPECT_EQ(state(), BusState::kLeased);
  EXPECT_EQ(engine_.asked_device(request), std::nullopt);
}

TEST_F(BusEngineTest, TheTextOfARequestCountsTheCommandsOfItsBatch) {
  feed(CommandArrived{write(ChannelTarget{"r0"}, 1)});
  feed(CommandArrived{write(ChannelTarget{"r1"}, 2)});
  EXPECT_EQ(engine_.request_text(sent_after(Opened{})),
            "unit-1: write holding:100..101 (r0, +1; command of mes)");
}

TEST_F(BusEngineTest, ABatchIsOneRequestOfOneArea) {
  feed(CommandArrived{write(AddressTarget{"holding:7", {}}, 1)});
  Command coil = write(AddressTarget{"coil:8", {ValueType::kBool}}, 2);
  coil.values = {Value{true}};
  feed(CommandArrived{coil});
  EXPECT_EQ(engine_.request_text(sent_after(Opened{})), "unit-1: write holding:7 (command of mes)");
}

TEST_F(BusEngineTest, ABatchIsNoLongerThanOneRequestCarries) {
  Command many = write(AddressTarget{"holding:100", {}}, 1);
  many.values.assign(123, Value{std::uint64_t{7}});
  feed(CommandArrived{many});
  feed(CommandArrived{write(AddressTarget{"holding:223", {}}, 2)});
  EXPECT_EQ(engine_.request_text(sent_after(Opened{})),
            "unit-1: write holding:100..222 (command of mes)");
}

TEST_F(BusEngineTest, ABatchHasABoundedNumberOfCommands) {
  for (std::uint64_t i = 0; i < CommandQueue::kMaxBatch + 6; ++i) {
    Command command = write(AddressTarget{"holding:" + std::to_string(100 + i), {}}, i);
    command.requester = "mes-" + std::to_string(i / 8);
    feed(CommandArrived{command});
  }
  const std::string text = engine_.request_text(sent_after(Opened{}));
  EXPECT_TRUE(text.starts_with("unit-1: write holding:100..163 (+63; command of mes-0")) << text;
}

TEST_F(BusEngineTest, TheTextOfABatchOfAddressesHasNoChannel) {
  feed(CommandArrived{write(AddressTarget{"holding:7", {}}, 1)});
  feed(CommandArrived{write(AddressTarget{"holding:8", {}}, 2)});
  EXPECT_EQ(engine_.request_text(sent_after(Opened{})),
            "unit-1: write holding:7..8 (+1; command of mes)");
}

// As after a change of the configuration between the two bridges.
TEST_F(BusEngineTest, WhatIsInheritedOfUnknownChannelsAndDevicesIsIgnored) {
  BusInheritance inherited;
  Sample sample{.channel = kChannelsOfDevice, .value = std::uint64_t{7}};
  sample.quality = Quality::kGood;
  sample.sequence = 41;
  inherited.samples = {sample};
  inherited.devices["gone"].exchanges = 5;
  engine_.inherit(inherited, now_);
  std::size_t samples = 0;
  for (const Action& action : feed(Opened{})) {
    if (const auto* publish = std::get_if<Publish>(&action)) samples += publish->samples.size();
  }
  EXPECT_EQ(samples, 0u);
  EXPECT_EQ(engine_.device_report(0, now_).exchanges, 0u);
}

TEST(BusParts, TheTextOfALongListShowsItsFirstRanges) {
  const BusParts parts(rtu_bus(1), plain_text_codec());
  std::vector<Range> ranges;
  for (std::uint32_t i = 0; i < 34; ++i) ranges.push_back({kHolding, 10 * i, 1});
  Flight flight;
  flight.kind = Flight::Kind::kProbe;
  flight.asked.request = ReadRequest{ranges};
  const std::string text = flight_text(parts, flight);
  EXPECT_TRUE(text.starts_with("unit-1: read holding:0, holding:10, ")) << text;
  EXPECT_TRUE(text.ends_with(", holding:310, +2 (is it back?)")) << text;
}

TEST(BusParts, ACommandThatHasEndedIsNotNamed) {
  const BusParts parts(rtu_bus(1), plain_text_codec());
  Flight flight;
  flight.kind = Flight::Kind::kCommand;
  flight.asked.request = ReadRequest{{{kHolding, 7, 2}}};
  EXPECT_EQ(flight_text(parts, flight), "unit-1: read holding:7..8");
}

TEST(BusParts, DevicesThatAreNotConfiguredHaveAPlaceEachAndNoMore) {
  const BusSpec spec = rtu_bus(1);
  BusParts parts(spec, plain_text_codec());
  std::uint64_t samples = 0;
  Actions actions;
  ActionSink sink(parts.setup, samples, actions);
  const auto refused = [&](std::uint16_t address, Duration timeout) -> std::string {
    auto device = spec.devices.front();
    device.link.address = address;
    device.name = "at-" + std::to_string(address);
    device.timeout = timeout;
    Command command;
    command.request_id = address;
    command.operation = Operation::kAcquire;
    command.target = ChannelTarget{"r0"};
    command.ad_hoc = std::make_shared<const DeviceSpec>(device);
    const auto admitted = parts.admit(command, Instant{});
    if (!admitted) return admitted.error().reason;
    parts.commands.accept(command, {}, Instant{}, sink);
    return "";
  };
  for (std::uint16_t address = 2; address < 2 + BusSetup::kMostAdHoc; ++address)
    EXPECT_EQ(refused(address, 200ms), "");
  EXPECT_EQ(refused(2, 200ms), "") << "the same device again";
  EXPECT_EQ(refused(2, 300ms), "an earlier request to this address is still pending");
  EXPECT_EQ(refused(100, 200ms), "requests to other devices are still pending");
}

}  // namespace
}  // namespace fieldcast::test
