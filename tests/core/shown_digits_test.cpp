// Decimals with which the values of a channel are shown.
#include <gtest/gtest.h>

#include "core/model/channel_spec.hpp"

namespace fieldcast {
namespace {

ChannelSpec scaled(double scale, double offset = 0, ValueType type = ValueType::kInt16) {
  ChannelSpec channel;
  channel.encoding.type = type;
  channel.encoding.scale = scale;
  channel.encoding.offset = offset;
  return channel;
}
int resolution(const ChannelSpec& channel) {
  const auto shown = shown_digits(channel);
  EXPECT_FALSE(shown && shown->configured);
  return shown ? shown->digits : -1;
}

TEST(ShownDigits, OfAnIntegerAreThoseOfItsScaleAndOffset) {
  EXPECT_EQ(resolution(scaled(1)), 0);
  EXPECT_EQ(resolution(scaled(10)), 0);
  EXPECT_EQ(resolution(scaled(0.1)), 1);
  EXPECT_EQ(resolution(scaled(-0.01)), 2);
  EXPECT_EQ(resolution(scaled(0.5)), 1);
  EXPECT_EQ(resolution(scaled(0.25)), 2);
  EXPECT_EQ(resolution(scaled(100.0 / 1023)), 3);
  EXPECT_EQ(resolution(scaled(1, -273.15)), 2);
  EXPECT_EQ(resolution(scaled(0.1, -40)), 1);
  EXPECT_EQ(resolution(scaled(1e-9)), 9);
}

TEST(ShownDigits, AreUnknownWithoutAResolution) {
  EXPECT_EQ(resolution(scaled(0.1, 0, ValueType::kFloat32)), -1);
  EXPECT_EQ(resolution(scaled(1, 0, ValueType::kBool)), -1);
  EXPECT_EQ(resolution(scaled(0.1, 0, ValueType::kFloat64)), -1);
  EXPECT_EQ(resolution(scaled(1, 0, ValueType::kString)), -1);
  EXPECT_EQ(resolution(scaled(0)), -1);
  EXPECT_EQ(resolution(scaled(1e-12)), -1);
  ChannelSpec exponent = scaled(0.1);
  exponent.encoding.exponent_distance = 4;
  EXPECT_EQ(resolution(exponent), -1);
}

TEST(ShownDigits, OfANumberAsTextAreThoseOfItsPicture) {
  ChannelSpec text = scaled(1, 0, ValueType::kFloat32);
  text.encoding.text_number = {.kind = TextNumber::Kind::kDecimal, .decimals = 2};
  EXPECT_EQ(resolution(text), 2);
}

TEST(ShownDigits, OfTheConfigurationHavePrecedence) {
  ChannelSpec channel = scaled(0.1);
  channel.digits = 3;
  EXPECT_EQ(shown_digits(channel), (ShownDigits{3, true}));
}

}  // namespace
}  // namespace fieldcast
