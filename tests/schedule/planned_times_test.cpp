#include "core/schedule/planned_times.hpp"

#include <gtest/gtest.h>

#include <array>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using Changes = std::vector<PlannedTime>;

constexpr std::array<std::size_t, 2> kAreas{2, 1};  // two devices

TEST(PlannedTimes, MicrosecondsMakeNoOtherPlan) {
  EXPECT_EQ(PlannedTimes::rounded(-1ms), 0ms);
  EXPECT_EQ(PlannedTimes::rounded(0ms), 0ms);
  for (const Duration time : {Duration{1990us}, Duration{2ms}, Duration{2005us}})
    EXPECT_EQ(PlannedTimes::rounded(time), 2ms);
  EXPECT_EQ(PlannedTimes::rounded(2100us), 2250us) << "rather too long than too short";
  EXPECT_EQ(PlannedTimes::rounded(20ms), 20ms);
  EXPECT_EQ(PlannedTimes::rounded(100ms), 100ms);
}

TEST(PlannedTimes, WhatHasNotAnsweredIsTakenToBeLikeWhatHas) {
  PlannedTimes times(kAreas, 5ms);
  EXPECT_EQ(times.answered(0, 1, 2005us), (Changes{{0, 1, 2ms}, {0, 0, 2ms}, {1, 0, 2ms}}));
  EXPECT_EQ(times.answered(1, 0, 9ms), (Changes{{1, 0, 9ms}})) << "the others are known";
}

TEST(PlannedTimes, SmallChangesAreNotTold) {
  PlannedTimes times(kAreas, 5ms);
  for (int i = 0; i < 200; ++i)
    EXPECT_EQ(times.answered(0, 0, i % 2 == 0 ? 4700us : 5200us), Changes{});
}

}  // namespace
}  // namespace fieldcast
