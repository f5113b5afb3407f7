#include <gtest/gtest.h>

#include "bridge/interest/interest_registry.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using Interests = std::map<ChannelIndex, Duration>;

BusSpec press_shop() {
  BusSpec bus;
  bus.name = "press-shop";
  for (const char* name : {"press-1", "press-2"}) {
    DeviceSpec device;
    device.name = name;
    for (const char* name_of_channel : {"oil", "speed"}) {
      ChannelSpec& channel = device.channels.emplace_back();
      channel.name = name_of_channel;
      channel.on_interest = true;
    }
    bus.devices.push_back(device);
  }
  return bus;
}

TEST(InterestTable, TheShortestRefreshOfAllStationsCounts) {
  InterestTable table;
  ASSERT_TRUE(table.note("a", "press-shop/press-1/oil", milliseconds{500}));
  ASSERT_TRUE(table.note("b", "press-shop/press-1/oil", milliseconds{200}));
  ASSERT_TRUE(table.note("c", "*/*/oil", milliseconds{300}));
  EXPECT_EQ(table.interests(press_shop()),
            (Interests{{0, milliseconds{200}}, {2, milliseconds{300}}}));
}

TEST(InterestTable, AnEndedInterestLeavesTheOthers) {
  InterestTable table;
  ASSERT_TRUE(table.note("a", "*/press-2/*", milliseconds{500}));
  ASSERT_TRUE(table.note("b", "*/press-2/*", milliseconds{100}));
  ASSERT_TRUE(table.note("b", "*/press-2/*", std::nullopt));
  EXPECT_EQ(table.interests(press_shop()),
            (Interests{{2, milliseconds{500}}, {3, milliseconds{500}}}));
  ASSERT_TRUE(table.note("a", "*/press-2/*", std::nullopt));
  EXPECT_TRUE(table.interests(press_shop()).empty());
}

TEST(InterestTable, ANewRefreshReplacesTheOld) {
  InterestTable table;
  ASSERT_TRUE(table.note("a", "*/press-1/oil", milliseconds{100}));
  ASSERT_TRUE(table.note("a", "*/press-1/oil", milliseconds{900}));
  EXPECT_EQ(table.interests(press_shop()), (Interests{{0, milliseconds{900}}}));
}

// press-shop/press-1/load is calculated of oil and mill/m/power, the latter of mill/m/current.
TEST(InterestTable, TheInterestInACalculatedChannelIsOneInItsInputs) {
  const auto calculated = [](const char* name, std::vector<ChannelPath> inputs) {
    ChannelSpec channel;
    channel.name = name;
    channel.calculation.value =
        std::make_shared<Calculation>(Calculation{"", std::move(inputs), "", {}});
    return channel;
  };
  BusSpec shop = press_shop(), mill;
  shop.devices[0].channels.push_back(
      calculated("load", {{"press-shop", "press-1", "oil"}, {"mill", "m", "power"}}));
  mill.name = "mill";
  DeviceSpec& m = mill.devices.emplace_back();
  m.name = "m";
  m.channels.push_back(calculated("power", {{"mill", "m", "current"}}));
  ChannelSpec& current = m.channels.emplace_back();
  current.name = "current";
  current.on_interest = true;

  InterestTable table;
  ASSERT_TRUE(table.note("a", "press-shop/press-1/load", milliseconds{300}));
  auto inputs = table.input_refreshes({&shop, &mill});
  EXPECT_EQ(table.interests(shop, inputs), (Interests{{0, milliseconds{300}}}));
  EXPECT_EQ(table.interests(mill, inputs), (Interests{{1, milliseconds{300}}}));
  ASSERT_TRUE(table.note("b", "mill", milliseconds{200}));
  ASSERT_TRUE(table.note("c", "press-shop/press-1/oil", milliseconds{100}));
  inputs = table.input_refreshes({&shop, &mill});
  EXPECT_EQ(table.interests(shop, inputs), (Interests{{0, milliseconds{100}}}));
  EXPECT_EQ(table.interests(mill, inputs), (Interests{{1, milliseconds{200}}}));
  ASSERT_TRUE(table.note("a", "press-shop/press-1/load", std::nullopt));
  inputs = table.input_refreshes({&shop, &mill});
  EXPECT_EQ(table.interests(shop, inputs), (Interests{{0, milliseconds{100}}}));
  EXPECT_EQ(InterestTable::reach(*Pattern::parse("press-shop/press-1/load"), shop).on_interest, 1u);
}

TEST(InterestTable, OtherBusesAreNotMeant) {
  InterestTable table;
  ASSERT_TRUE(table.note("a", "mill/*/*", milliseconds{100}));
  EXPECT_TRUE(table.interests(press_shop()).empty());
}

TEST(InterestTable, NonsenseIsRefusedWithAReason) {
  InterestTable table;
  EXPECT_FALSE(table.note("a", "one/two/three/four", milliseconds{100}));
  EXPECT_FALSE(table.note("a", "*/*/*", milliseconds{0}));
  EXPECT_FALSE(table.note("a", "*/*/*", milliseconds{-5}));
  EXPECT_FALSE(table.note("a", "*/*/*", std::chrono::microseconds{999}));
  EXPECT_FALSE(table.note("a", "*/*/*", std::chrono::hours{25}));
  EXPECT_TRUE(table.interests(press_shop()).empty());
}

TEST(InterestTable, WithdrawingWhatWasNeverDeclaredIsNotAFault) {
  InterestTable table;
  EXPECT_TRUE(table.note("a", "*/*/*", std::nullopt));
}

TEST(InterestTable, MemoryIsBounded) {
  InterestTable table;
  for (std::size_t i = 0; i < InterestTable::kMaxPatterns; ++i) {
    ASSERT_TRUE(table.note("a", "bus-" + std::to_string(i), milliseconds{100}));
  }
  EXPECT_FALSE(table.note("a", "one-more", milliseconds{100}));
  EXPECT_TRUE(table.note("b", "bus-1", milliseconds{100}));
  ASSERT_TRUE(table.note("a", "bus-0", std::nullopt));
  EXPECT_TRUE(table.note("a", "one-more", milliseconds{100}));
  for (std::size_t i = InterestTable::kMaxPatterns + 1; i < InterestTable::kMaxInterests; ++i) {
    ASSERT_TRUE(table.note("s" + std::to_string(i), "bus-1", milliseconds{100}));
  }
  EXPECT_FALSE(table.note("too many", "bus-1", milliseconds{100}));
}

TEST(InterestTable, AMillionInterestsAreRefusedImmediatelyAndLeaveThoseThatStand) {
  InterestTable table;
  ASSERT_TRUE(table.note("honest", "*/press-1/oil", milliseconds{200}));
  std::size_t taken = 0;
  for (int i = 0; i < 500'000; ++i) {
    taken += table.note("s", "press-shop/press-" + std::to_string(i), milliseconds{100})
                 .has_value();  // patterns,
    taken += table.note("s" + std::to_string(i), "*/press-1/oil", milliseconds{100})
                 .has_value();  // stations,
  }
  EXPECT_EQ(taken, InterestTable::kMaxInterests - 1);
  for (int i = 1; i < 1'000'000; ++i)
    ASSERT_TRUE(table.note("honest", "*/press-1/oil", milliseconds{i % 1000 + 1}));  // changes
  ASSERT_TRUE(table.note("honest", "*/press-1/oil", milliseconds{50}));
  EXPECT_EQ(table.interests(press_shop()).at(0), milliseconds{50});
  EXPECT_EQ(table.take_new().size(), InterestTable::kMaxNew);
  EXPECT_TRUE(table.take_new().empty());
}

TEST(InterestTable, RefusalSaysWhoWhatAndWhy) {
  InterestTable table;
  for (std::size_t i = 0; i < InterestTable::kMaxPatterns; ++i)
    ASSERT_TRUE(table.note("a", "b" + std::to_string(i), milliseconds{9}));
  EXPECT_EQ(
      table.note("a", "x/y/z", milliseconds{9}).error(),
      "station a: its interest in x/y/z is refused: 256 interests of 256 patterns are held, at "
      "most 4096 of 256");
}

TEST(InterestTable, ChannelsThatAreReadAnywayAreNoInterest) {
  BusSpec bus = press_shop();
  bus.devices[0].channels[0].on_interest = false;
  InterestTable table;
  ASSERT_TRUE(table.note("a", "*/press-1/*", milliseconds{500}));
  EXPECT_EQ(table.interests(bus), (Interests{{1, milliseconds{500}}}));
}

TEST(InterestTable, ReachReportsAnInterestInNothing) {
  BusSpec bus = press_shop();
  bus.devices[0].channels[0].on_interest = false;
  const auto reach = [&](const char* pattern) {
    return InterestTable::reach(*Pattern::parse(pattern), bus);
  };
  EXPECT_EQ(reach("mill/*/*").channels, 0u);
  EXPECT_EQ(reach("*/press-3/*").channels, 0u);
  EXPECT_EQ(reach("*/press-1/oil").channels, 1u);
  EXPECT_EQ(reach("*/press-1/oil").on_interest, 0u);
  EXPECT_EQ(reach("*/*/oil").channels, 2u);
  EXPECT_EQ(reach("*/*/oil").on_interest, 1u);
}

TEST(InterestTable, NewsAreInterestsThatWereNotKnown) {
  InterestTable table;
  ASSERT_TRUE(table.note("a", "*/press-1/*", milliseconds{500}));
  ASSERT_TRUE(table.note("b", "*/press-1/*", milliseconds{500}));
  EXPECT_EQ(table.take_new().size(), 2u);
  ASSERT_TRUE(table.note("b", "*/press-1/*", milliseconds{100}));
  EXPECT_TRUE(table.take_new().empty());
}

TEST(InterestChanges, OnlyDifferencesAreReported) {
  const Interests before{{0, milliseconds{100}}, {1, milliseconds{100}}, {2, milliseconds{100}}};
  const Interests after{{0, milliseconds{100}}, {1, milliseconds{50}}, {3, milliseconds{100}}};
  const auto told = changes(before, after);
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told[0].channel, 1u);
  EXPECT_EQ(told[0].refresh, milliseconds{50});
  EXPECT_EQ(told[1].channel, 3u);
  EXPECT_EQ(told[2].channel, 2u);
  EXPECT_EQ(told[2].refresh, std::nullopt);
}

}  // namespace
}  // namespace fieldcast
