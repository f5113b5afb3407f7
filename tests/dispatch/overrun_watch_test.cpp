#include <gtest/gtest.h>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// Adds 256 acquisitions from `now` on, one per millisecond, with every `late_each`-th late.
void window(OverrunWatch& watch, Instant& now, int late_each, bool rests = false) {
  for (int i = 0; i < 256; ++i) {
    watch.wire_free(now, rests);
    now += 1ms;
    watch.wire_free(now, false);
    watch.acquired(late_each != 0 && i % late_each == 0, now);
  }
}

TEST(OverrunWatch, LatePointsOnAWireThatNeverRestsAreOverrun) {
  OverrunWatch watch;
  Instant now{1s};
  window(watch, now, 0);
  EXPECT_EQ(watch.overrun(), 1);
  window(watch, now, 5);
  EXPECT_DOUBLE_EQ(watch.overrun(), 1.05);
  window(watch, now, 50);
  EXPECT_DOUBLE_EQ(watch.overrun(), 1.05) << "few";
  window(watch, now, 0);
  EXPECT_LT(watch.overrun(), 1.05) << "none: it fades";
}

TEST(OverrunWatch, AWireThatRestsIsNotOverrun) {
  OverrunWatch watch;
  Instant now{1s};
  window(watch, now, 2, true);
  EXPECT_EQ(watch.overrun(), 1);
}

TEST(OverrunWatch, WhatIsLateInTheFirstRoundOfAPlanDoesNotCount) {
  OverrunWatch watch;
  Instant now{1s};
  watch.plan_began(now + 10s);
  window(watch, now, 2);
  EXPECT_EQ(watch.overrun(), 1);
}

TEST(OverrunWatch, HasALimit) {
  OverrunWatch watch;
  Instant now{1s};
  for (int i = 0; i < 200; ++i) window(watch, now, 2);
  EXPECT_EQ(watch.overrun(), 16);
}

}  // namespace
}  // namespace fieldcast
