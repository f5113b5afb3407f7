#include <gtest/gtest.h>

#include "core/bus/health/learning.hpp"
#include "core/bus/health/overload_watch.hpp"
#include "core/bus/wire/wire.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(WireLoad, SharesAreOfTheTimeSinceTheReportBefore) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  load.ended(200ms, true);
  load.ended(300ms, false);
  const auto shares = load.report(0ms, false, Instant{1s});
  EXPECT_DOUBLE_EQ(shares.busy, 0.5);
  EXPECT_DOUBLE_EQ(shares.reading, 0.2);
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{2s}).busy, 0);
}

TEST(WireLoad, SharesAreAtMostTheWholeTime) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  load.ended(1100ms, true);
  const auto none = load.report(0ms, false, Instant{});
  EXPECT_DOUBLE_EQ(none.busy, 0) << "no time has passed";
  EXPECT_DOUBLE_EQ(none.reading, 0);
  const auto whole = load.report(0ms, false, Instant{1s});
  EXPECT_DOUBLE_EQ(whole.busy, 1);
  EXPECT_DOUBLE_EQ(whole.reading, 1);
}

TEST(WireLoad, TheExchangeOnTheWireCountsAsFarAsItHasCome) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  EXPECT_DOUBLE_EQ(load.report(400ms, true, Instant{1s}).busy, 0.4);
  load.ended(600ms, true);
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{2s}).busy, 0.2);
}

TEST(WireLoad, ReadsAreSharedOverTenSeconds) {
  WireLoad load;
  for (int second = 0; second < 30; ++second) {
    if (second < 15) load.ended(500ms, true);
    (void)load.report(0ms, false, Instant{std::chrono::seconds{second}});
  }
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{30s}).reading, 0);
  load.ended(1s, true);
  EXPECT_NEAR(load.report(0ms, false, Instant{31s}).reading, 0.1, 0.01);
}

TEST(WireLoad, AReportBetweenTheRegularOnesSetsNoMark) {
  WireLoad load;
  (void)load.report(0ms, false, Instant{});
  load.ended(500ms, false);
  (void)load.report(0ms, false, Instant{500ms});
  EXPECT_DOUBLE_EQ(load.report(0ms, false, Instant{1s}).busy, 0.5);
}

TEST(OverloadWatch, IsReportedOnceItHasLastedAndOnce) {
  OverloadWatch watch(1);
  EXPECT_FALSE(watch.update(1.5, Instant{1s}));
  EXPECT_FALSE(watch.update(1.5, Instant{5999ms}));
  const auto told = watch.update(1.5, Instant{6s});
  ASSERT_TRUE(told);
  EXPECT_EQ(told->kind, Notice::Kind::kOverload);
  EXPECT_NE(told->text.find("up to 1.50 times"), std::string::npos) << told->text;
  EXPECT_FALSE(watch.update(1.8, Instant{60s}));
}

TEST(OverloadWatch, AnInterruptionBeginsTheTimeAgain) {
  OverloadWatch watch(1);
  EXPECT_FALSE(watch.update(1.5, Instant{1s}));
  EXPECT_FALSE(watch.update(1.0, Instant{3s}));
  EXPECT_FALSE(watch.update(1.5, Instant{4s}));
  EXPECT_FALSE(watch.update(1.5, Instant{8s}));
  EXPECT_TRUE(watch.update(1.5, Instant{9s}));
}

TEST(OverloadWatch, OfTheConfigurationOnlyTheEndIsNews) {
  OverloadWatch watch(2);
  EXPECT_FALSE(watch.update(2, Instant{1s}));
  EXPECT_FALSE(watch.update(2, Instant{100s}));
  EXPECT_FALSE(watch.update(1, Instant{101s}));
  const auto told = watch.update(1, Instant{106s});
  ASSERT_TRUE(told);
  EXPECT_EQ(told->kind, Notice::Kind::kOverloadEnded);
}

TEST(ResponseTime, UnknownDeviceGetsTheConfiguredTimeout) {
  const ResponseTime time(200ms, 20ms);
  EXPECT_EQ(time.timeout(), 200ms);
  EXPECT_FALSE(time.known());
}

TEST(ResponseTime, SteadyResponsesShortenTheTimeout) {
  ResponseTime time(200ms, 20ms);
  for (int i = 0; i < 100; ++i) time.learn(5ms);
  EXPECT_EQ(time.mean(), 5ms);
  EXPECT_LT(time.timeout(), 31ms);
  EXPECT_GE(time.timeout(), 30ms);
}

TEST(ResponseTime, NeverAboveTheConfiguredTimeout) {
  ResponseTime time(200ms, 20ms);
  for (int i = 0; i < 10; ++i) time.learn(150ms);
  EXPECT_EQ(time.timeout(), 200ms);
}

TEST(ResponseTime, TimeoutsDoubleItUntilTheNextResponse) {
  ResponseTime time(1s, 20ms);
  for (int i = 0; i < 100; ++i) time.learn(5ms);
  const Duration before = time.timeout();
  time.timed_out();
  EXPECT_EQ(time.timeout(), 2 * before);
  for (int i = 0; i < 20; ++i) time.timed_out();
  EXPECT_EQ(time.timeout(), 1s);
  time.learn(5ms);
  EXPECT_LE(time.timeout(), before);
}

TEST(ResponseTime, SpreadWidensIt) {
  ResponseTime time(1s, 20ms);
  for (int i = 0; i < 100; ++i) time.learn(i % 2 ? 5ms : 45ms);
  EXPECT_GT(time.timeout(), 100ms);
}

TEST(ResponseTime, NegativeMeasurementsCountAsZero) {
  ResponseTime time(1s, 20ms);
  time.learn(-3ms);
  EXPECT_EQ(time.mean(), 0ms);
}

TEST(ResponseTime, IsNeverShorterThanTheLongestOfTheLastResponses) {
  ResponseTime time(1s, 20ms);
  for (int i = 0; i < 50; ++i) time.learn(5ms);
  time.learn(150ms);
  for (int i = 0; i < 200; ++i) time.learn(5ms);
  EXPECT_GE(time.timeout(), 150ms);
  for (int i = 0; i < 600; ++i) time.learn(5ms);
  EXPECT_LT(time.timeout(), 31ms) << "it is long ago";
  time.late(400ms);
  EXPECT_GE(time.timeout(), 400ms) << "what had been given up counts as well";
}

TEST(ResponseTime, WhatBeginsBeforeItsRequestHasEndedIsNotAResponse) {
  ResponseTime time(1s, 20ms);
  EXPECT_FALSE(time.too_early(-5ms, 500us)) << "nothing is known";
  for (int i = 0; i < 50; ++i) time.learn(2ms);
  EXPECT_TRUE(time.too_early(-5ms, 500us));
  EXPECT_FALSE(time.too_early(0ms, 500us));
  EXPECT_EQ(time.earliest(500us), 2ms);
  time.learn(-4ms);
  EXPECT_EQ(time.earliest(500us), 2ms);
  EXPECT_TRUE(time.too_early(-5ms, 500us)) << "that one may have been another master's";
  time.learn(-4ms);
  EXPECT_FALSE(time.too_early(-5ms, 500us)) << "this line does not keep to its baud rate";
  EXPECT_FALSE(time.earliest(500us));
}

}  // namespace
}  // namespace fieldcast
