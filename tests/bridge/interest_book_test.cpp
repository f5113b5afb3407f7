#include "bridge/interest_book.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using Wishes = std::map<ChannelIndex, Duration>;

BusSpec press_shop() {
  BusSpec bus;
  bus.name = "press-shop";
  for (const char* name : {"press-1", "press-2"}) {
    DeviceSpec device;
    device.name = name;
    for (const char* channel : {"oil", "speed"}) device.channels.emplace_back().name = channel;
    bus.devices.push_back(device);
  }
  return bus;
}

TEST(InterestBook, TheShortestWishOfAllStationsCounts) {
  InterestBook book;
  ASSERT_TRUE(book.note("a", "press-shop/press-1/oil", milliseconds{500}));
  ASSERT_TRUE(book.note("b", "press-shop/press-1/oil", milliseconds{200}));
  ASSERT_TRUE(book.note("c", "*/*/oil", milliseconds{300}));
  EXPECT_EQ(book.wishes(press_shop()), (Wishes{{0, milliseconds{200}}, {2, milliseconds{300}}}));
}

TEST(InterestBook, AnEndedWishLeavesTheOthers) {
  InterestBook book;
  ASSERT_TRUE(book.note("a", "*/press-2/*", milliseconds{500}));
  ASSERT_TRUE(book.note("b", "*/press-2/*", milliseconds{100}));
  ASSERT_TRUE(book.note("b", "*/press-2/*", std::nullopt));
  EXPECT_EQ(book.wishes(press_shop()), (Wishes{{2, milliseconds{500}}, {3, milliseconds{500}}}));
  ASSERT_TRUE(book.note("a", "*/press-2/*", std::nullopt));
  EXPECT_TRUE(book.wishes(press_shop()).empty());
}

TEST(InterestBook, ANewRefreshReplacesTheOld) {
  InterestBook book;
  ASSERT_TRUE(book.note("a", "*/press-1/oil", milliseconds{100}));
  ASSERT_TRUE(book.note("a", "*/press-1/oil", milliseconds{900}));
  EXPECT_EQ(book.wishes(press_shop()), (Wishes{{0, milliseconds{900}}}));
}

TEST(InterestBook, OtherBusesAreNotWished) {
  InterestBook book;
  ASSERT_TRUE(book.note("a", "mill/*/*", milliseconds{100}));
  EXPECT_TRUE(book.wishes(press_shop()).empty());
}

TEST(InterestBook, NonsenseIsRefusedWithAReason) {
  InterestBook book;
  EXPECT_FALSE(book.note("a", "one/two/three/four", milliseconds{100}));
  EXPECT_FALSE(book.note("a", "*/*/*", milliseconds{0}));
  EXPECT_FALSE(book.note("a", "*/*/*", milliseconds{-5}));
  EXPECT_TRUE(book.wishes(press_shop()).empty());
}

TEST(InterestBook, WithdrawingWhatWasNeverWishedIsNoFault) {
  InterestBook book;
  EXPECT_TRUE(book.note("a", "*/*/*", std::nullopt));
}

TEST(InterestBook, MemoryIsBounded) {
  InterestBook book;
  for (std::size_t i = 0; i < InterestBook::kMaxPatterns; ++i) {
    ASSERT_TRUE(book.note("a", "bus-" + std::to_string(i), milliseconds{100}));
  }
  EXPECT_FALSE(book.note("a", "one-more", milliseconds{100}));
  EXPECT_TRUE(book.note("b", "bus-1", milliseconds{100}));
  ASSERT_TRUE(book.note("a", "bus-0", std::nullopt));
  EXPECT_TRUE(book.note("a", "one-more", milliseconds{100}));
  for (std::size_t i = InterestBook::kMaxPatterns + 1; i < InterestBook::kMaxWishes; ++i) {
    ASSERT_TRUE(book.note("s" + std::to_string(i), "bus-1", milliseconds{100}));
  }
  EXPECT_FALSE(book.note("too many", "bus-1", milliseconds{100}));
}

TEST(InterestChanges, OnlyDifferencesAreTold) {
  const Wishes before{{0, milliseconds{100}}, {1, milliseconds{100}}, {2, milliseconds{100}}};
  const Wishes after{{0, milliseconds{100}}, {1, milliseconds{50}}, {3, milliseconds{100}}};
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
