#include "bridge/base/back_off.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

TEST(BackOff, DoublesFromATenthOfASecondToThirtySeconds) {
  BackOff back_off;
  std::vector<Duration> waits;
  for (int i = 0; i < 11; ++i) waits.push_back(back_off.closed(kStart));
  EXPECT_EQ(waits[0], milliseconds{100});
  EXPECT_EQ(waits[1], milliseconds{200});
  EXPECT_EQ(waits[8], milliseconds{25600});
  EXPECT_EQ(waits[9], seconds{30});
  EXPECT_EQ(waits[10], seconds{30});
}

TEST(BackOff, APortThatStayedOpenRestarts) {
  BackOff back_off;
  for (int i = 0; i < 5; ++i) (void)back_off.closed(kStart);
  back_off.opened(kStart);
  EXPECT_EQ(back_off.closed(kStart + BackOff::kProven), BackOff::kFirst);
}

TEST(BackOff, RestartsWhenThereIsANewReason) {
  BackOff back_off;
  for (int i = 0; i < 5; ++i) (void)back_off.closed(kStart);
  back_off.reset();
  EXPECT_EQ(back_off.closed(kStart), BackOff::kFirst);
}

TEST(BackOff, APortThatFallsImmediatelyDoesNot) {
  BackOff back_off;
  (void)back_off.closed(kStart);
  back_off.opened(kStart);
  EXPECT_EQ(back_off.closed(kStart + milliseconds{1}), milliseconds{200});
}

}  // namespace
}  // namespace fieldcast
