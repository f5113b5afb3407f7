#include "core/model/overlap.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

ChannelSpec channel(std::string name, AreaIndex area, std::uint32_t first, std::uint32_t count,
                    ValueType type) {
  ChannelSpec spec;
  spec.name = std::move(name);
  spec.at = "holding:" + std::to_string(first);
  spec.range = {area, first, count};
  spec.encoding.type = type;
  return spec;
}

// "a-b c-d": the names of each overlap.
std::string overlaps(std::vector<ChannelSpec> channels) {
  BusSpec bus;
  bus.devices.emplace_back().channels = std::move(channels);
  std::string text;
  for (const Overlap& each : overlaps_of(bus))
    text += (text.empty() ? "" : " ") + each.first->name + '-' + each.second->name;
  return text;
}

constexpr ValueType kWord = ValueType::kUint16, kDouble = ValueType::kUint32;

TEST(Overlaps, AreItemsOfTwoTypes) {
  EXPECT_EQ(overlaps({channel("a", 0, 100, 2, kDouble), channel("b", 0, 101, 2, kDouble)}), "a-b");
  EXPECT_EQ(overlaps({channel("b", 0, 101, 2, kDouble), channel("a", 0, 100, 2, kDouble)}), "a-b");
  EXPECT_EQ(overlaps({channel("a", 0, 100, 2, kDouble), channel("b", 0, 102, 2, kDouble)}), "");
  EXPECT_EQ(overlaps({channel("a", 0, 100, 2, kDouble), channel("b", 1, 101, 2, kDouble)}), "");
  EXPECT_EQ(overlaps({channel("a", 0, 100, 2, kDouble), channel("b", 0, 100, 2, kDouble)}), "")
      << "a second name";
  EXPECT_EQ(overlaps({channel("a", 0, 100, 1, kWord), channel("b", 0, 100, 2, kDouble)}), "a-b");
  EXPECT_EQ(overlaps({channel("a", 0, 100, 1, kWord), channel("b", 0, 100, 1, ValueType::kInt16)}),
            "a-b");
}

TEST(Overlaps, AreFoundBehindAShorterChannel) {
  EXPECT_EQ(
      overlaps({channel("long", 0, 100, 8, ValueType::kString), channel("short", 0, 101, 1, kWord),
                channel("last", 0, 107, 1, kWord), channel("free", 0, 108, 1, kWord)}),
      "long-short long-last");
  EXPECT_EQ(overlaps({channel("long", 0, 100, 8, ValueType::kString),
                      channel("other", 1, 100, 1, kWord), channel("wide", 1, 100, 2, kDouble)}),
            "other-wide")
      << "the long one is in another area";
}

TEST(Overlaps, BitsAndCalculatedChannelsHaveNone) {
  ChannelSpec bit = channel("bit", 0, 100, 1, ValueType::kBool);
  bit.encoding.bit = 3;
  EXPECT_EQ(overlaps({bit, channel("word", 0, 100, 1, kWord)}), "");
}

TEST(Overlaps, TheItemOfAnExponentIsShared) {
  ChannelSpec behind = channel("a", 0, 100, 3, kWord);  // value 100, exponent 102
  behind.encoding.exponent_distance = 2;
  ChannelSpec before = channel("b", 0, 97, 4, kWord);  // exponent 97, value 100
  before.encoding.exponent_distance = -3;
  EXPECT_EQ(overlaps({behind, channel("e", 0, 102, 1, ValueType::kInt16)}), "");
  EXPECT_EQ(overlaps({before, channel("e", 0, 97, 1, ValueType::kInt16)}), "");
  EXPECT_EQ(overlaps({behind, before}), "") << "the same value";
  EXPECT_EQ(overlaps({before, channel("f", 0, 100, 2, kDouble)}), "b-f");
}

TEST(Overlaps, AreDescribedWithTheirAddresses) {
  BusSpec bus;
  DeviceSpec& device = bus.devices.emplace_back();
  device.name = "press-1";
  device.channels = {channel("a", 0, 100, 2, kDouble), channel("b", 0, 101, 2, kDouble)};
  EXPECT_EQ(to_text(overlaps_of(bus).at(0)),
            "press-1/a (holding:100, uint32) and press-1/b (holding:101, uint32) overlap in "
            "another type: is one of the addresses off by one?");
}

TEST(Overlaps, ACalculatedChannelHasNoItems) {
  ChannelSpec calculated = channel("sum", 0, 101, 2, kDouble);
  calculated.calculation = {std::make_shared<Calculation>()};
  EXPECT_EQ(overlaps({channel("a", 0, 100, 2, kDouble), calculated}), "");
}

}  // namespace
}  // namespace fieldcast
