#include <gmock/gmock.h>

#include <future>

#include "tests/bridge/support/bridge_fixture.hpp"
#include "tests/bridge/support/captured_log.hpp"
#include "tests/bridge/support/modbus_device.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::BridgeTest;
using test::CapturedLog;
using test::ModbusDevice;
using test::Receiver;

TEST_F(BridgeTest, AChannelOnInterestIsReadOnceAStationIsInterested) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  spec.buses[0].devices[0].channels[0].on_interest = true;
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  const auto of_interest = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r0" && s.quality == Quality::kGood;
  };
  const auto other = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r1" && s.sequence >= 3;
  };
  ASSERT_TRUE(receiver.receives(other));
  for (const StationSample& sample : receiver.samples()) EXPECT_FALSE(of_interest(sample));
  receiver.station.declare_interest("one/plc/r0", milliseconds{100});
  EXPECT_TRUE(
      receiver.receives([&](const StationSample& s) { return of_interest(s) && s.sequence >= 5; }));
}

TEST_F(BridgeTest, AnInterestInNothingIsToldOnceAndAFloodOfThemHoldsNobodyUp) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::promise<void> renewed;
  receiver.station.subscribe_channels([&, told = false](const StationChannel& channel) mutable {
    if (!told && channel.bus == "one" && channel.channel == "r0" &&
        channel.refresh == milliseconds{50})
      renewed.set_value(), told = true;
  });
  spec.buses[0].devices[0].channels[0].on_interest = true;
  Bridge bridge;
  CapturedLog log;
  ASSERT_TRUE(bridge.start(spec));
  const auto good = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r0" && s.quality == Quality::kGood;
  };
  receiver.station.declare_interest("one/plc/r0", milliseconds{100});
  EXPECT_TRUE(receiver.receives(good));
  receiver.station.declare_interest("one/plc/r1", milliseconds{100});
  for (int i = 0; i < 3000; ++i)
    receiver.station.declare_interest("nowhere/" + std::to_string(i), milliseconds{100});
  receiver.station.declare_interest(
      "one/plc/r0",
      milliseconds{50});  // interests of one station arrive in order: this is the last
  EXPECT_EQ(renewed.get_future().wait_for(seconds{15}), std::future_status::ready);
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good));
  bridge.stop();
  const std::string said = log.end();
  EXPECT_THAT(said,
              testing::HasSubstr("in one/plc/r1 changes nothing: its channels are read anyway"));
  EXPECT_THAT(said, testing::HasSubstr("are held, at most 4096 of 256"));
  EXPECT_LT(std::count(said.begin(), said.end(), '\n'), 20) << said;
}

}  // namespace
}  // namespace fieldcast
