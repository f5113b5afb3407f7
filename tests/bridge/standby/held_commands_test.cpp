#include "bridge/standby/held_commands.hpp"

#include <gmock/gmock.h>

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Held = HeldCommands<std::string>;
constexpr Instant kNow{std::chrono::hours{1}};
constexpr Instant kSoon = kNow + std::chrono::seconds{5};

struct HeldCommandsTest : testing::Test {
  HeldCommandsTest() { held.stand_by(); }
  void hold(std::uint64_t id) {
    EXPECT_TRUE(held.hold("bus", {"mes", id}, std::to_string(id), kSoon, kNow));
  }
  Held held;
};

TEST_F(HeldCommandsTest, WhatHasNoResponseRunsInTheOrderInWhichItCame) {
  hold(3);
  hold(1);
  hold(2);
  held.completed({"mes", 1});
  EXPECT_THAT(held.take_over(kNow), ElementsAre("3", "2"));
}

TEST_F(HeldCommandsTest, WhatTheMasterHasBegunIsNeverRunAgain) {
  hold(1);
  held.begun("bus", {"mes", 1}, kSoon);
  held.begun("bus", {"mes", 2}, kSoon);  // the note arrived before the command
  hold(2);
  held.begun("bus", {"mes", 3}, kSoon);
  held.completed({"mes", 3});
  EXPECT_THAT(held.take_over(kNow), IsEmpty());
  EXPECT_TRUE(held.waits());
  const auto left = held.give_up();
  EXPECT_FALSE(held.waits());
  EXPECT_THAT(left.to_run, IsEmpty());
  ASSERT_EQ(left.begun.size(), 2u);
  EXPECT_EQ(left.begun[0].key.second, 1u);
  EXPECT_EQ(left.begun[1].key.second, 2u);
  EXPECT_EQ(left.begun[1].bus, "bus");
}

TEST_F(HeldCommandsTest, WhatTheMasterGivesBackRuns) {
  hold(1);
  held.begun("bus", {"mes", 1}, kSoon);
  held.returned({"mes", 1});
  EXPECT_THAT(held.take_over(kNow), ElementsAre("1"));
}

// The note of a master that has handed over may arrive before its last results.
TEST_F(HeldCommandsTest, ANewMasterWaitsForWhatTheOneBeforeHasBegun) {
  for (const std::uint64_t id : {1, 2, 3}) hold(id);
  for (const std::uint64_t id : {1, 2, 3, 4}) held.begun("bus", {"mes", id}, kSoon);
  EXPECT_THAT(held.take_over(kNow), IsEmpty());
  held.completed({"mes", 1});
  held.returned({"mes", 2});
  EXPECT_TRUE(held.waits());
  EXPECT_TRUE(held.hold("bus", {"mes", 4}, "4", kSoon, kNow)) << "it comes late, and was begun";
  EXPECT_FALSE(held.hold("bus", {"mes", 5}, "5", kSoon, kNow));
  const auto left = held.give_up();
  EXPECT_THAT(left.to_run, ElementsAre("2"));
  ASSERT_EQ(left.begun.size(), 2u);
  EXPECT_EQ(left.begun[0].key.second, 3u);
  EXPECT_EQ(left.begun[1].key.second, 4u);
  EXPECT_FALSE(held.waits());
}

TEST_F(HeldCommandsTest, AResponseMayComeBeforeItsCommand) {
  held.completed({"mes", 1});
  hold(1);
  EXPECT_THAT(held.take_over(kNow), IsEmpty());
}

TEST_F(HeldCommandsTest, WhatIsTooOldIsForgotten) {
  hold(1);
  EXPECT_THAT(held.take_over(kSoon + Held::kLonger), IsEmpty());
}

// Their results may have been sent while it was disconnected.
TEST_F(HeldCommandsTest, WhoJoinsOnceMoreRunsNothingOfBefore) {
  hold(1);
  held.begun("bus", {"mes", 2}, kSoon);
  held.completed({"mes", 3});
  held.join();
  hold(3);
  EXPECT_EQ(held.size(), 0u) << "what was heard stays heard";
  hold(4);
  EXPECT_THAT(held.take_over(kNow), ElementsAre("4"));
  EXPECT_THAT(held.give_up().begun, IsEmpty());
}

// The master of term 1 may never have received it.
TEST_F(HeldCommandsTest, TheMasterIsNotifiedOfWhatHasNoResult) {
  hold(1);
  hold(2);
  EXPECT_THAT(held.without_result(1, kNow), IsEmpty()) << "most have their result soon";
  const Instant later = kNow + Held::kTellAfter;
  held.completed({"mes", 2});
  const auto told = held.without_result(1, later);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].bus, "bus");
  EXPECT_EQ(told[0].key.second, 1u);
  EXPECT_FALSE(told[0].begun);
  EXPECT_THAT(held.without_result(1, later), IsEmpty()) << "not at once again";
  EXPECT_EQ(held.without_result(1, later + Held::kTellAfter).size(), 1u) << "it may not have heard";
}

TEST_F(HeldCommandsTest, ANewMasterIsNotifiedOfWhatTheOneBeforeHasBegun) {
  held.begun("bus", {"mes", 1}, kNow + std::chrono::minutes{1});
  EXPECT_THAT(held.without_result(1, kNow), IsEmpty());
  EXPECT_THAT(held.without_result(2, kNow + Held::kTellAfter), IsEmpty());
  const auto told = held.without_result(2, kNow + 2 * Held::kTellAfter);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(told[0].begun);
}

TEST_F(HeldCommandsTest, AMasterIsNotNotifiedForEver) {
  EXPECT_TRUE(held.hold("bus", {"mes", 1}, "1", kNever, kNow));
  Instant now = kNow;
  std::size_t told = 0;
  for (int i = 0; i < 60; ++i) told += held.without_result(1, now += Held::kTellAfter).size();
  EXPECT_EQ(told, Held::kMostTold);
  for (int i = 0; i < 60; ++i) told += held.without_result(2, now += Held::kTellAfter).size();
  EXPECT_EQ(told, 2 * Held::kMostTold);
}

// A bridge that rejoins forgets its held commands.
TEST_F(HeldCommandsTest, TheMasterIsImmediatelyNotifiedOfWhatWouldBeForgotten) {
  hold(1);
  hold(2);
  hold(3);
  held.completed({"mes", 2});
  held.begun("bus", {"mes", 3}, kNow + std::chrono::minutes{1});
  const auto told = held.last_words(kNow);
  ASSERT_EQ(told.size(), 1u) << "the master has 3";
  EXPECT_EQ(told[0].key.second, 1u);
  held.join();
  EXPECT_THAT(held.last_words(kNow), IsEmpty());
}

TEST_F(HeldCommandsTest, AMasterHoldsNothing) {
  (void)held.take_over(kNow);
  EXPECT_FALSE(held.hold("bus", {"mes", 1}, "1", kSoon, kNow));
  held.stand_by();
  hold(1);
  EXPECT_EQ(held.size(), 1u);
}

}  // namespace
}  // namespace fieldcast
