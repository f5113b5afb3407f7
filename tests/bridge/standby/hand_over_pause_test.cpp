#include "bridge/standby/hand_over_pause.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kHandedOver{100s};

TEST(HandOverPause, IsEmptyUntilTheHandOverHasEnded) {
  const HandOverPause pause;
  EXPECT_FALSE(pause.has_begun());
  EXPECT_EQ(pause.left(kHandedOver), 0ns);
}

TEST(HandOverPause, LastsFromTheEndOfTheHandOver) {
  HandOverPause pause;
  pause.begin(kHandedOver);
  EXPECT_TRUE(pause.has_begun());
  EXPECT_EQ(pause.left(kHandedOver), HandOverPause::kLength);
  EXPECT_EQ(pause.left(kHandedOver + HandOverPause::kLength - 1ns), 1ns);
  EXPECT_EQ(pause.left(kHandedOver + HandOverPause::kLength), 0ns);
  EXPECT_EQ(pause.left(kHandedOver + 1h), 0ns);
}

TEST(HandOverPause, IsNotExtendedByASecondBegin) {
  HandOverPause pause;
  pause.begin(kHandedOver);
  pause.begin(kHandedOver + 300ms);
  EXPECT_EQ(pause.left(kHandedOver + 300ms), HandOverPause::kLength - 300ms);
  pause.begin(kHandedOver + 1h);
  EXPECT_EQ(pause.left(kHandedOver + 1h), 0ns);
}

}  // namespace
}  // namespace fieldcast
