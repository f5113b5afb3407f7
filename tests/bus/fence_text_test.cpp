#include <gtest/gtest.h>

#include "core/bus/wire/fence_setup.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

BusSpec bus_with(const PortSpec& port, const std::string& protocol) {
  BusSpec bus;
  bus.name = "bus";
  bus.port = port;
  DeviceSpec device;
  device.name = "unit";
  device.protocol = protocol;
  device.channels.resize(1);
  device.channels.front().range = {2, 0, 1};
  bus.devices.push_back(device);
  return bus;
}

SerialPortSpec serial(std::optional<Fence> fence) {
  SerialPortSpec port;
  port.path = "/dev/ttyUSB0";
  port.fence.kind = fence;
  return port;
}

TcpPortSpec tcp(std::optional<Fence> fence, bool line) {
  TcpPortSpec port;
  port.host = "server";
  if (line) port.line = LineFormat{};
  port.fence.kind = fence;
  return port;
}

TEST(FenceText, SaysWhichFenceAPortHasAndWhetherOneIsMissing) {
  const auto text = [](const PortSpec& port, const char* protocol = "modbus-rtu") {
    return fence_text(bus_with(port, protocol));
  };
  EXPECT_TRUE(text(serial({})).missing);
  EXPECT_TRUE(text(serial(Fence::kNone)).missing);
  EXPECT_FALSE(text(serial(Fence::kListen)).missing);
  EXPECT_FALSE(text(serial(Fence::kLock)).missing);
  EXPECT_TRUE(text(tcp({}, true)).missing);
  EXPECT_FALSE(text(tcp(Fence::kListen, true)).missing);
  EXPECT_FALSE(text(tcp(Fence::kOneClient, true)).missing);
  EXPECT_FALSE(text(tcp({}, false), "modbus-tcp").missing);
  EXPECT_TRUE(text(tcp({}, false)).missing) << "frames of a line over TCP: a serial server";
  EXPECT_FALSE(text(DialInPortSpec{"17", {}}).missing);
  Rfc2217PortSpec rfc2217{"server", 4001, LineFormat{}};
  EXPECT_TRUE(text(rfc2217).missing);
  rfc2217.fence.kind = Fence::kOneClient;
  EXPECT_FALSE(text(rfc2217).missing);
  EXPECT_NE(text(serial(Fence::kListen)).text.find("silent for 420ms"), std::string::npos)
      << text(serial(Fence::kListen)).text;
}

// A listener that waits this long has received the sender, however slow the devices are.
TEST(FenceTimes, TheListenerWaitsLongerThanTheOneThatSendsIsEverSilent) {
  BusSpec bus = bus_with(serial(Fence::kListen), "modbus-rtu");
  bus.devices.front().timeout = 1s;
  bus.devices.front().pause = 300ms;
  bus.gap_allowance = 20ms;
  const FenceTimes times = fence_times(bus);
  EXPECT_EQ(times.hold, 100ms);
  EXPECT_EQ(times.quiet, 1320ms);
  EXPECT_EQ(times.claim, 1420ms);
  EXPECT_EQ(times.listen, 1520ms);
  bus.devices.front().timeout = 10ms;
  bus.devices.front().pause = 0ms;
  EXPECT_EQ(fence_times(bus).listen, 300ms) << "three times the hold at least";
}

// If responses cannot be matched to requests, no request is sent while a late one can arrive.
TEST(FenceTimes, OfAProtocolWhoseResponsesShowNothingAreLonger) {
  BusSpec bus = bus_with(serial(Fence::kListen), "s7-freeport");
  bus.devices.front().channels.front().range = {0, 0, 1};
  EXPECT_EQ(fence_times(bus).quiet, 620ms);
}

// The pause between acknowledgement and poll of PPI is 10 ms; a device may need one of its own.
TEST(FenceTimes, CountThePausesOfAnExchange) {
  BusSpec bus = bus_with(serial(Fence::kListen), "s7-ppi");
  bus.devices.front().channels.front().range = {0, 0, 1};
  EXPECT_EQ(fence_times(bus).quiet, 230ms);
  bus.devices.front().pause = 50ms;
  EXPECT_EQ(fence_times(bus).quiet, 280ms);
}

TEST(FenceText, AFenceOfAServerIsNamedForEveryProtocol) {
  for (const Fence fence : {Fence::kListen, Fence::kOneClient}) {
    const FenceText of_server = fence_text(bus_with(tcp(fence, false), "modbus-tcp"));
    EXPECT_FALSE(of_server.missing);
    EXPECT_EQ(of_server.text.find("none"), std::string::npos) << of_server.text;
  }
}

// Drivers of RS-485 that change their direction add 00 or FF.
TEST(RequestFinder, AFrameMayFollowCharactersOfATurnaround) {
  const RequestFinder finder(bus_with(serial(Fence::kListen), "modbus-rtu"));
  const Bytes response{0x02, 0x03, 0x04, 0x00, 0x00, 0x00, 0x00, 0xC9, 0x33};
  const auto is_frame_behind = [&](Bytes before) {
    append(before, response);
    return finder.is_frame(before);
  };
  EXPECT_TRUE(is_frame_behind({}));
  EXPECT_TRUE(is_frame_behind({0x00}));
  EXPECT_TRUE(is_frame_behind({0xFF}));
  EXPECT_TRUE(is_frame_behind({0xFF, 0x00, 0x00}));
  EXPECT_FALSE(is_frame_behind({0x55}));
  EXPECT_FALSE(finder.is_frame({}));
  EXPECT_FALSE(finder.is_frame(Bytes(8, 0x00)));
  EXPECT_FALSE(finder.is_frame(ByteView(response).first(8)));
}

// A poll of DF1: DLE, ENQ, the station and its check.
TEST(RequestFinder, TheShortestFrameHasFourCharacters) {
  const RequestFinder finder(bus_with(serial(Fence::kListen), "allen-bradley-df1"));
  EXPECT_TRUE(finder.is_frame(Bytes{0x10, 0x05, 0x11, 0xEF}));
  EXPECT_FALSE(finder.is_frame(Bytes{0x10, 0x05, 0x11}));
  EXPECT_FALSE(finder.is_frame(Bytes{0x10, 0x05, 0x11, 0xEE}));
}

}  // namespace
}  // namespace fieldcast
