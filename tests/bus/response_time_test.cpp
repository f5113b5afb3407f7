#include <gtest/gtest.h>

#include "core/bus/health/learning.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Duration kConfigured{10s}, kAllowance{20ms}, kCharacter{1ms};

struct ResponseTimeTest : testing::Test {
  void learn(Duration measured, int times = 1) {
    for (int i = 0; i < times; ++i) time.learn(measured);
  }
  ResponseTime time{kConfigured, kAllowance};
};

TEST_F(ResponseTimeTest, TheTimeoutIsTheConfiguredOneUntilAResponse) {
  EXPECT_EQ(time.timeout(), kConfigured);
  EXPECT_FALSE(time.known());
  EXPECT_EQ(time.mean(), 0ms);
  learn(40ms);
  EXPECT_TRUE(time.known());
  time.forget();
  EXPECT_EQ(time.timeout(), kConfigured);
  EXPECT_EQ(time.mean(), 0ms);
  EXPECT_EQ(time.longest(), 0ms);
}

// RFC 6298, 2.2 and 2.3, with the mean doubled: see ResponseTime::timeout().
TEST_F(ResponseTimeTest, MeanAndSpreadFollowTheResponsesAsRoundTripsOfTcp) {
  learn(40ms);
  EXPECT_EQ(time.mean(), 40ms);
  EXPECT_EQ(time.spread(), 20ms) << "half of the first";
  EXPECT_EQ(time.timeout(), 180ms) << "2 * 40 + 4 * 20 + 20";
  learn(40ms);
  EXPECT_EQ(time.spread(), 15ms) << "a quarter of the way to 0";
  EXPECT_EQ(time.timeout(), 160ms);
  learn(48ms);
  EXPECT_EQ(time.mean(), 41ms) << "an eighth of the way to 48";
  EXPECT_EQ(time.spread(), 13250us) << "a quarter of the way from 15 to 8";
  learn(33ms);
  EXPECT_EQ(time.mean(), 40ms);
  EXPECT_EQ(time.spread(), 11937500ns) << "a deviation to the other side counts as much";
}

TEST_F(ResponseTimeTest, EachTimeoutDoublesTheNextOneUntilAResponse) {
  learn(40ms);
  for (const Duration expected : {360ms, 720ms, 1440ms, 2880ms, 5760ms, 10000ms, 10000ms}) {
    time.timed_out();
    EXPECT_EQ(time.timeout(), expected);
  }
  learn(40ms);
  EXPECT_EQ(time.timeout(), 160ms);
}

TEST_F(ResponseTimeTest, TheTimeoutDoublesAtMostEightTimes) {
  time = ResponseTime(24h, kAllowance);
  learn(40ms);
  for (int i = 0; i < 40; ++i) time.timed_out();
  EXPECT_EQ(time.timeout(), 256 * 180ms);
}

TEST_F(ResponseTimeTest, TheLongestResponseOfTheLast256IsWaitedFor) {
  learn(500ms);
  learn(10ms, 256);
  EXPECT_EQ(time.longest(), 500ms);
  EXPECT_EQ(time.timeout(), 520ms);
  learn(10ms, 256);
  EXPECT_EQ(time.longest(), 10ms);
  EXPECT_LT(time.timeout(), 100ms);
  time.late(300ms);
  EXPECT_EQ(time.longest(), 300ms) << "a late response counts";
  time.late(200ms);
  EXPECT_EQ(time.longest(), 300ms);
}

TEST_F(ResponseTimeTest, AResponseBeforeTheEndOfTheRequestCountsAsZero) {
  learn(-3ms);
  EXPECT_EQ(time.mean(), 0ms);
  EXPECT_EQ(time.spread(), 0ms);
  EXPECT_EQ(time.timeout(), kAllowance);
}

TEST_F(ResponseTimeTest, TheEarliestIsTheSecondShortestOfSixteenOrMore) {
  learn(10ms, 14);
  learn(2ms);
  EXPECT_FALSE(time.earliest(kCharacter)) << "15 responses";
  learn(10ms);
  EXPECT_EQ(time.earliest(kCharacter), 10ms) << "the shortest one may be wrong";
  learn(3ms);
  EXPECT_EQ(time.earliest(kCharacter), 3ms);
  learn(1ms);
  EXPECT_EQ(time.earliest(kCharacter), 2ms);
}

TEST_F(ResponseTimeTest, TheEarliestIsForgottenAfterTwoWindows) {
  learn(2ms, 2);
  learn(10ms, 254);
  learn(10ms);
  EXPECT_EQ(time.earliest(kCharacter), 2ms) << "one response of the second window";
  learn(10ms, 255);
  EXPECT_EQ(time.earliest(kCharacter), 2ms);
  learn(10ms, 2);
  EXPECT_EQ(time.earliest(kCharacter), 10ms);
}

TEST_F(ResponseTimeTest, TheUsualTimeIsTheLongestOneWithTheMarginUntil64Responses) {
  EXPECT_EQ(time.usual(20ms), 20ms);
  learn(8ms);
  learn(10ms, 62);
  EXPECT_EQ(time.usual(20ms), 30ms) << "63 responses";
  learn(10ms);
  EXPECT_EQ(time.usual(20ms), 10ms);
}

TEST_F(ResponseTimeTest, TheUsualTimeIsWithoutARareLongOne) {
  learn(10ms, 64);
  learn(500ms);
  learn(10ms, 64);
  EXPECT_EQ(time.longest(), 500ms);
  EXPECT_LT(time.usual(20ms), 12ms);
}

TEST_F(ResponseTimeTest, ALineThatDoesNotKeepItsRateHasNoEarliest) {
  learn(-1ms, 16);
  EXPECT_FALSE(time.earliest(kCharacter)) << "a character too early, twice and more";
  EXPECT_EQ(time.earliest(2 * kCharacter), -1ms);
}

TEST_F(ResponseTimeTest, AResponseThatBeginsInTheRequestBelongsToAnother) {
  learn(10ms, 15);
  EXPECT_FALSE(time.too_early(-3ms, kCharacter)) << "too few responses";
  learn(10ms);
  EXPECT_TRUE(time.too_early(-3ms, kCharacter));
  EXPECT_FALSE(time.too_early(-2ms, kCharacter)) << "within two characters";
}

}  // namespace
}  // namespace fieldcast
