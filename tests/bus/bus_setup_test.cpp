#include "core/bus/setup/bus_setup.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/bus/bus_engine.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kHolding;

TEST(BusSetup, DevicesAreFoundByName) {
  const BusSetup setup(test::rtu_bus(2));
  EXPECT_EQ(setup.find("unit-2"), DeviceIndex{1});
  EXPECT_FALSE(setup.find("unit-3"));
}

TEST(BusSetup, WireTimeIsThatOfEveryCharacter) {
  const BusSetup setup(test::rtu_bus(1));
  const Request read = ReadRequest{{{kHolding, 100, 2}}};
  EXPECT_EQ(setup.response_wire_time(0, read), setup.line().characters(9));
  EXPECT_EQ(setup.wire_time(0, read), setup.line().characters(8 + 9));
}

TEST(BusSetup, TheResponseToAWriteOfOneRegisterIsItsEchoAndThatToAReadIsNot) {
  const BusSetup setup(test::rtu_bus(1));
  EXPECT_FALSE(setup.response_differs(0, WriteRequest{{kHolding, 100, 1}, {0, 1}, {}}));
  EXPECT_TRUE(setup.response_differs(0, ReadRequest{{{kHolding, 100, 1}}}));
}

TEST(BusSetup, ASerialServerIsNotPlainTcp) {
  BusSpec bus = test::rtu_bus(1);
  EXPECT_FALSE(BusSetup(bus).plain_tcp());
  bus.port = TcpPortSpec{"10.0.0.7", 502, {}, 3s};
  EXPECT_TRUE(BusSetup(bus).plain_tcp());
  bus.port = TcpPortSpec{"10.0.0.7", 502, LineFormat{}, 3s};
  EXPECT_FALSE(BusSetup(bus).plain_tcp());
}

TEST(BusSetup, RangesAreNamedByTheirArea) {
  const BusSetup setup(test::rtu_bus(1));
  EXPECT_EQ(setup.text(0, {kHolding, 105, 3}), "holding:105..107");
  EXPECT_EQ(setup.text(0, {kHolding, 105, 1}), "holding:105");
}

TEST(BusSetup, ARequestThatNoFrameCarriesHasNoWireTime) {
  const BusSetup setup(test::rtu_bus(1));
  const Request much = ReadRequest{{{kHolding, 100, 1000}}};
  EXPECT_EQ(setup.wire_time(0, much), Duration{});
  EXPECT_EQ(setup.response_wire_time(0, much), Duration{});
}

TEST(BusSetup, EachRequestHasOneArea) {
  const WriteRequest write{{kHolding, 100, 1}, {0, 1}, {}};
  EXPECT_EQ(area_of(ReadRequest{{{3, 100, 1}}}), 3u);
  EXPECT_EQ(area_of(write), kHolding);
  EXPECT_EQ(area_of(WriteReadRequest{write, {3, 100, 1}}), 3u);
}

TEST(BusSetup, OnALineOfOneDeviceNoOtherIsRead) {
  for (const char* protocol : {"mitsubishi-fx", "s7-freeport"}) {
    BusSpec spec = test::rtu_bus(1);
    spec.devices[0].protocol = protocol;
    DeviceSpec other = spec.devices[0];
    other.link.address = 2;
    EXPECT_EQ(BusSetup(spec).why_not_ad_hoc(other),
              "the protocol " + std::string(protocol) + " allows only one device on its bus");
  }
}

TEST(BusSetup, AddressesDifferByTheirLongPartToo) {
  const DeviceSpec device = test::rtu_bus(1).devices[0];
  DeviceSpec other = device;
  EXPECT_TRUE(same_address(device, other));
  other.link.long_address = 7;
  EXPECT_FALSE(same_address(device, other));
}

// Responses that are still pending refer to the protocol of their device.
TEST(BusSetup, AnAdHocDeviceKeepsItsProtocolUntilItsLinkChanges) {
  BusSetup setup(test::rtu_bus(1));
  DeviceSpec device = setup.device(0);
  device.link.address = 2;
  ASSERT_TRUE(setup.set_ad_hoc(1, device));
  const auto first = setup.protocols()[1];
  device.timeout = 1s;
  ASSERT_TRUE(setup.set_ad_hoc(1, device));
  EXPECT_EQ(setup.protocols()[1], first);
  EXPECT_EQ(setup.device(1).timeout, 1s);
  device.link.options["mask-write"] = "true";
  ASSERT_TRUE(setup.set_ad_hoc(1, device));
  EXPECT_NE(setup.protocols()[1], first);
}

}  // namespace
}  // namespace fieldcast

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

bool sends(BusEngine& engine, const BusEvent& event, Instant now) {
  Actions actions;
  engine.on_event(event, now, actions);
  make_plans(engine, now, actions);
  return std::ranges::any_of(
      actions, [](const Action& action) { return std::holds_alternative<Send>(action); });
}

TEST(Successor, WaitsAsLongAsItsPredecessorSaysResponsesMayCome) {
  const BusSpec spec = rtu_bus(1);
  BusEngine before(spec);
  Instant now{10s};
  (void)sends(before, Opened{}, now);
  EXPECT_EQ(before.responses_until(), kLongAgo);
  while (!sends(before, TimerFired{}, now)) now += 1ms;
  (void)sends(before, StopRequested{}, now);
  const Instant until = before.responses_until();
  EXPECT_GE(until, now + PendingResponses::kLateFactor * spec.devices[0].timeout);

  BusEngine after(spec);
  EXPECT_FALSE(sends(after, Opened{until}, now));
  for (; now < until; now += 1ms) EXPECT_FALSE(sends(after, TimerFired{}, now));
  bool sent = false;
  for (int i = 0; i < 100 && !sent; ++i) sent = sends(after, TimerFired{}, now += 1ms);
  EXPECT_TRUE(sent);
}

TEST(Successor, WaitsForNothingWhereNothingWasAsked) {
  BusEngine before(rtu_bus(1));
  (void)sends(before, Opened{}, Instant{10s});
  (void)sends(before, StopRequested{}, Instant{10s} + 1us);
  EXPECT_EQ(before.responses_until(), kLongAgo);
}

}  // namespace
}  // namespace fieldcast::test
