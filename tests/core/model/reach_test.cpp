#include "core/model/reach.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> remarks(const Encoding& encoding, const Limits& limits) {
  BusSpec bus;
  DeviceSpec& device = bus.devices.emplace_back();
  device.name = "plc";
  ChannelSpec channel;
  channel.name = "a";
  channel.encoding = encoding;
  channel.limits = limits;
  device.channels = {channel};
  return unreachable_limits(bus);
}

Limits low_high(std::optional<double> low, std::optional<double> high) {
  return {.low_low = {}, .low = low, .high = high, .high_high = {}};
}

TEST(Reach, OfALimitIsThatOfTheType) {
  const Encoding word{.type = ValueType::kUint16};
  EXPECT_THAT(remarks(word, low_high({}, 65534)), IsEmpty());
  EXPECT_THAT(
      remarks(word, low_high(0, 65535)),
      ElementsAre("plc/a: no value is below the limit 'low' 0; its type has 0 to 65535",
                  "plc/a: no value is above the limit 'high' 65535; its type has 0 to 65535"));
  EXPECT_THAT(remarks({.type = ValueType::kInt8},
                      {.low_low = -128, .low = -127, .high = {}, .high_high = 128}),
              ElementsAre(testing::HasSubstr("'low-low' -128; its type has -128 to 127"),
                          testing::HasSubstr("'high-high' 128; its type has -128 to 127")));
  EXPECT_THAT(remarks({.type = ValueType::kUint32}, low_high({}, 4294967294)), IsEmpty());
  EXPECT_THAT(remarks({.type = ValueType::kBcd16}, low_high(1, 9998)), IsEmpty());
  EXPECT_EQ(remarks({.type = ValueType::kBcd16}, low_high({}, 9999)).size(), 1u);
}

TEST(Reach, OfALimitIsScaled) {
  const Encoding tenths{.type = ValueType::kUint16, .scale = 0.1, .offset = -50};
  EXPECT_THAT(remarks(tenths, low_high(-49.9, 6503.4)), IsEmpty());
  EXPECT_EQ(remarks(tenths, low_high(-50, 6503.5)).size(), 2u);
  const Encoding turned{.type = ValueType::kUint16, .scale = -1};
  EXPECT_THAT(remarks(turned, low_high(-65534, -1)), IsEmpty());
  EXPECT_EQ(remarks(turned, low_high(-65535, 0)).size(), 2u);
}

TEST(Reach, OfOtherChannelsIsNotKnown) {
  const Limits wide = low_high(-1e30, 1e30);
  EXPECT_THAT(remarks({.type = ValueType::kFloat32}, wide), IsEmpty());
  EXPECT_THAT(remarks({.type = ValueType::kUint16, .exponent_distance = 1}, wide), IsEmpty());
}

TEST(Reach, OfACalculatedChannelIsUnknown) {
  BusSpec bus;
  ChannelSpec channel;
  channel.encoding = {.type = ValueType::kUint16};
  channel.limits = low_high({}, 65535);
  channel.calculation = {std::make_shared<Calculation>()};
  bus.devices.emplace_back().channels = {channel};
  EXPECT_THAT(unreachable_limits(bus), IsEmpty());
}

}  // namespace
}  // namespace fieldcast
