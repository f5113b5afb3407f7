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
