// Commands that a waiting bridge holds while another one is master.
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
    EXPECT_TRUE(held.hold({"mes", id}, std::to_string(id), kSoon, kNow));
  }
  Held held;
};

TEST_F(HeldCommandsTest, WhatIsNotAnsweredRunsInTheOrderInWhichItCame) {
  hold(3);
  hold(1);
  hold(2);
  held.answered({"mes", 1});
  EXPECT_THAT(held.take_over(kNow).to_run, ElementsAre("3", "2"));
}

TEST_F(HeldCommandsTest, WhatTheMasterHasBegunIsNeverRunAgain) {
  hold(1);
  held.begun("bus", {"mes", 1}, kSoon);
  held.begun("bus", {"mes", 2}, kSoon);  // the note came before the command
  hold(2);
  held.begun("bus", {"mes", 3}, kSoon);
  held.answered({"mes", 3});
  const auto left = held.take_over(kNow);
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
  EXPECT_THAT(held.take_over(kNow).to_run, ElementsAre("1"));
}

TEST_F(HeldCommandsTest, AnAnswerMayComeBeforeItsCommand) {
  held.answered({"mes", 1});
  hold(1);
  EXPECT_THAT(held.take_over(kNow).to_run, IsEmpty());
}

TEST_F(HeldCommandsTest, WhatIsTooOldIsForgotten) {
  hold(1);
  EXPECT_THAT(held.take_over(kSoon + Held::kLonger).to_run, IsEmpty());
}

// Their results may have been told while it could not hear.
TEST_F(HeldCommandsTest, WhoJoinsOnceMoreRunsNothingOfBefore) {
  hold(1);
  held.begun("bus", {"mes", 2}, kSoon);
  held.answered({"mes", 3});
  held.join();
  hold(3);
  EXPECT_EQ(held.size(), 0u) << "what was heard stays heard";
  hold(4);
  const auto left = held.take_over(kNow);
  EXPECT_THAT(left.to_run, ElementsAre("4"));
  EXPECT_THAT(left.begun, IsEmpty());
}

TEST_F(HeldCommandsTest, AMasterHoldsNothing) {
  (void)held.take_over(kNow);
  EXPECT_FALSE(held.hold({"mes", 1}, "1", kSoon, kNow));
  held.stand_by();
  hold(1);
  EXPECT_EQ(held.size(), 1u);
}

}  // namespace
}  // namespace fieldcast
