#include <gtest/gtest.h>

#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

BridgeSpec with(const Encoding& encoding) {
  ChannelSpec channel;
  channel.name = "power";
  channel.encoding = encoding;
  DeviceSpec device;
  device.channels = {channel};
  BusSpec bus;
  bus.devices = {device};
  BridgeSpec bridge;
  bridge.buses = {bus};
  return bridge;
}

TEST(CommonConfiguration, IsAnotherWithAnotherExponent) {
  const std::string none = common_configuration(with({}));
  const std::string behind = common_configuration(with({.exponent_distance = 2}));
  EXPECT_EQ(none, common_configuration(with({})));
  EXPECT_NE(none, behind);
  EXPECT_NE(behind, common_configuration(with({.exponent_distance = -2})));
  // As before there were exponents, or a group is not one while its members are upgraded.
  EXPECT_EQ(none, "af37ba9c1dc337a2");
}

}  // namespace
}  // namespace fieldcast
