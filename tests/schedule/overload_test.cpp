#include "core/schedule/overload.hpp"

#include <gmock/gmock.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

BusSpec bus_of(std::uint32_t registers, Duration refresh, std::uint32_t baud) {
  BusSpec bus;
  bus.name = "one";
  SerialPortSpec port;
  port.line = {baud, 8, Parity::kEven, 1};
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.link.address = 1;
  for (std::uint32_t i = 0; i < registers; ++i) {
    ChannelSpec channel;
    channel.name = "r" + std::to_string(i);
    channel.range = {2, 150 * i, 1};
    channel.refresh = refresh;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

TEST(LoadCheck, ABusWithRoomHasNone) {
  EXPECT_FALSE(overload_of(bus_of(10, 1s, 19200), 5ms));
  EXPECT_FALSE(hopeless_load_of(bus_of(10, 1s, 19200)));
}

TEST(LoadCheck, LoadAndStretchAreThoseOfThePlan) {
  // 19 ms each: 15 characters of 11 bits, two silences and 5 ms; 80 reads need 1.5 s.
  const auto overload = overload_of(bus_of(80, 1s, 19200), 5ms);
  ASSERT_TRUE(overload);
  EXPECT_NEAR(overload->load, 1.5, 0.2);
  EXPECT_NEAR(overload->stretch, overload->load, 0.2);
  EXPECT_EQ(overload->baud, 38400u);
  EXPECT_FALSE(overload_of(bus_of(80, 1s, 38400), 5ms));
}

TEST(LoadCheck, ARefreshShorterThanItsOwnReadCountsAsItIsAskedFor) {
  const auto overload = overload_of(bus_of(1, 1ms, 19200), 5ms);
  ASSERT_TRUE(overload);
  EXPECT_GT(overload->load, 15);
  EXPECT_GT(overload->stretch, 15);
  EXPECT_FALSE(overload->baud);
}

TEST(LoadCheck, WhatIsReadOnlyOnDemandOrOnInterestCostsNothing) {
  BusSpec bus = bus_of(100, 1s, 19200);
  for (ChannelSpec& channel : bus.devices[0].channels) channel.on_interest = true;
  bus.devices[0].channels[0].on_interest = false;
  bus.devices[0].channels[1].mode = Mode::kOnDemand;
  EXPECT_FALSE(overload_of(bus, 5ms));
}

TEST(LoadCheck, HopelessIsAHundredTimesTheWireAtTheLeast) {
  EXPECT_FALSE(hopeless_load_of(bus_of(400, 100ms, 19200)));
  const auto load = hopeless_load_of(bus_of(400, 10ms, 19200));
  ASSERT_TRUE(load);
  EXPECT_NEAR(*load, 500, 100);
}

TEST(LoadCheck, TextSaysHowMuchAndHowToMend) {
  EXPECT_THAT(to_text(Overload{2.5, 2.625, 57600}),
              testing::AllOf(HasSubstr("2.50 times"), HasSubstr("2.62 times as long"),
                             HasSubstr("at 57600 baud or more"), HasSubstr("'fieldcast plan'")));
  EXPECT_THAT(to_text(Overload{30, 31, std::nullopt}),
              testing::AllOf(HasSubstr("30 times"), Not(HasSubstr("baud"))));
}

}  // namespace
}  // namespace fieldcast
