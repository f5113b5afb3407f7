// What a dispatcher learns of a wire: its overrun, and the pace of its devices.
#include <gtest/gtest.h>

#include "core/dispatch/plan_runner.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr int kWindow = 256;  // acquisitions

class OverrunWatchTest : public testing::Test {
 protected:
  // A window of acquisitions, 10 ms apart. The first `late` of them are late.
  void window(int late, Duration rest = {}) {
    if (rest > Duration::zero()) {
      watch_.acquired(late > 0, now_);
      watch_.wire_free(now_, true);
      now_ += rest;
      watch_.wire_free(now_, false);
      now_ += 10ms;
    }
    for (int i = rest > Duration::zero() ? 1 : 0; i < kWindow; ++i, now_ += 10ms)
      watch_.acquired(i < late, now_);
  }
  OverrunWatch watch_;
  Instant now_{100s};
};

TEST_F(OverrunWatchTest, GrowsByFivePerCentIfMoreThanATwentiethIsLate) {
  window(12);
  EXPECT_EQ(watch_.overrun(), 1) << "a twentieth";
  window(13);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05);
  window(1);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05) << "some are still late";
  window(256);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05 * 1.05);
}

TEST_F(OverrunWatchTest, ShrinksByOnePerCentIfNothingIsLate) {
  window(20);
  window(0);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05 * 0.99);
  for (int i = 0; i < 10; ++i) window(0);
  EXPECT_EQ(watch_.overrun(), 1) << "as planned";
}

TEST_F(OverrunWatchTest, AWireThatRestsIsNotTooSlow) {
  window(20);
  // Two per cent of a window of 2.55 s are 51 ms, and the rest is part of the window.
  window(20, 51ms);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05 * 1.05);
  window(20, 54ms);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05 * 1.05 * 0.99);
}

TEST_F(OverrunWatchTest, IsNeverMoreThanSixteen) {
  for (int i = 0; i < 100; ++i) window(20);
  EXPECT_EQ(watch_.overrun(), 16);
}

TEST_F(OverrunWatchTest, TheRoundAfterAChangeOfPlansDoesNotCount) {
  watch_.plan_began(now_ + 1s);
  for (int i = 0; i < 100; ++i, now_ += 10ms) watch_.acquired(true, now_);
  window(12);
  EXPECT_EQ(watch_.overrun(), 1);
  window(13);
  EXPECT_DOUBLE_EQ(watch_.overrun(), 1.05);
}

TEST(LinePace, IsTheSlowestOfTheLastSixteenReads) {
  LinePace pace;
  EXPECT_EQ(pace.share(), 1);
  for (int i = 0; i < 15; ++i) pace.read(5ms, 10ms);
  EXPECT_EQ(pace.share(), 1) << "the first window is not complete";
  pace.read(8ms, 10ms);
  EXPECT_EQ(pace.share(), 0.8);
  EXPECT_EQ(pace.of(10ms), 8ms);
  for (int i = 0; i < 15; ++i) pace.read(5ms, 10ms);
  EXPECT_EQ(pace.share(), 0.8) << "of the window before";
  pace.read(5ms, 10ms);
  EXPECT_EQ(pace.share(), 0.5);
  pace.read(7ms, 10ms);
  EXPECT_EQ(pace.share(), 0.7) << "a slower read counts immediately";
}

TEST(LinePace, SmallDifferencesAndLongerReadsDoNotCount) {
  LinePace pace;
  for (int i = 0; i < 16; ++i) pace.read(9ms, 10ms);
  EXPECT_EQ(pace.share(), 1);
  EXPECT_EQ(pace.of(10ms), 10ms);
  for (int i = 0; i < 16; ++i) pace.read(8990us, 10ms);
  EXPECT_LT(pace.share(), 0.9);
  pace.read(50ms, 10ms);
  EXPECT_EQ(pace.share(), 1);
  LinePace nothing;
  for (int i = 0; i < 16; ++i) nothing.read(1ms, 0ms);
  EXPECT_EQ(nothing.share(), 1);
}

}  // namespace
}  // namespace fieldcast
