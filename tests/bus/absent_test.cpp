// Values that a response does not have: another form of it, or a block without them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bus/virtual_bus.hpp"
#include "tests/support/declared_bus.hpp"
#include "tests/support/multimeter.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualBus;

BusSpec bus_of(std::string_view text) { return test::bus_by(text, "meter", test::kMultimeter); }

constexpr std::string_view kMeter = R"(
bridge: b
buses:
  - name: bus
    port: { serial: /dev/ttyS0, baud: 19200 }
    protocol: meter
    devices:
      - name: m
        address: 1
        channels:
          - { name: volts, at: volts, type: uint16, refresh: 200ms }
          - { name: amperes, at: amperes, type: uint32, refresh: 200ms }
          - { name: battery, at: battery, type: uint8, refresh: 200ms }
)";

constexpr std::string_view kQueue = R"(
bridge: b
buses:
  - name: bus
    port: { serial: /dev/ttyS0, baud: 19200 }
    protocol: modbus-rtu
    devices:
      - name: recorder
        address: 1
        channels:
          - { name: queued, at: "fifo:7", type: uint16, refresh: 200ms,
              limits: { low: 0, high: 40 } }
          - { name: second, at: "fifo:7:2", type: uint16, refresh: 200ms }
)";

TEST(Absent, AValueThatIsNotInTheResponseTakesNoOtherWithIt) {
  sim::BusFaults first_form;
  first_form.devices["m"].form = 0;
  VirtualBus bus(bus_of(kMeter), first_form, 1);
  bus.run_until(bus.now() + 150s);
  const auto& channels = bus.channels();
  for (const std::size_t there : {0u, 2u}) {
    EXPECT_EQ(channels[there].quality, Quality::kGood);
    EXPECT_GE(channels[there].good, 740u);
    EXPECT_LE(channels[there].longest_gap, 220ms);
  }
  EXPECT_EQ(channels[1].quality, Quality::kBadRange);
  EXPECT_EQ(channels[1].good, 0u);
}

// The device sends one of two forms at a time. The record is requested for its other values, so an
// absent one is seen as soon as it is sent again.
TEST(Absent, AValueIsGoodWhileItsFormIsSent) {
  VirtualBus bus(bus_of(kMeter), {}, 1);
  bus.run_until(bus.now() + 300s);
  const auto& channels = bus.channels();
  EXPECT_GE(channels[2].good, 1480u);
  for (const std::size_t sometimes : {0u, 1u}) EXPECT_GE(channels[sometimes].good, 300u);
  EXPECT_NEAR(static_cast<double>(channels[0].good + channels[1].good),
              static_cast<double>(channels[2].good), 2);
}

TEST(Absent, ARegisterOfAQueueIsReadAsSoonAsItIsQueued) {
  VirtualBus bus(bus_of(kQueue), {}, 1);
  sim::SimDevice& device = *bus.plant().members()[0].device;
  ASSERT_TRUE(device.poke("fifo", 7 * 32, 1));
  bus.run_until(bus.now() + 20s);
  const auto& channels = bus.channels();
  EXPECT_EQ(channels[0].quality, Quality::kGood);
  EXPECT_EQ(channels[1].quality, Quality::kBadRange);
  EXPECT_EQ(channels[1].good, 0u);
  ASSERT_TRUE(device.poke("fifo", 7 * 32, 2));
  bus.run_until(bus.now() + 400ms);
  EXPECT_EQ(channels[1].quality, Quality::kGood);
  EXPECT_GE(channels[1].good, 1u);
  ASSERT_TRUE(device.poke("fifo", 7 * 32, 0));
  bus.run_until(bus.now() + 400ms);
  EXPECT_EQ(channels[1].quality, Quality::kBadRange);
}

}  // namespace
}  // namespace fieldcast
