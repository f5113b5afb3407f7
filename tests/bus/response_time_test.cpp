#include <gtest/gtest.h>

#include "core/bus/health/learning.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(ResponseTime, UnknownDeviceGetsTheConfiguredTimeout) {
  const ResponseTime time(200ms, 20ms);
  EXPECT_EQ(time.timeout(), 200ms);
  EXPECT_FALSE(time.known());
}

TEST(ResponseTime, SteadyAnswersShortenTheTimeout) {
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

TEST(ResponseTime, TimeoutsDoubleItUntilTheNextAnswer) {
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

TEST(ResponseTime, IsNeverShorterThanTheLongestOfTheLastAnswers) {
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

TEST(ResponseTime, WhatBeginsBeforeItsRequestHasEndedIsNoAnswer) {
  ResponseTime time(1s, 20ms);
  EXPECT_FALSE(time.too_early(-5ms, 500us)) << "nothing is known";
  for (int i = 0; i < 50; ++i) time.learn(2ms);
  EXPECT_TRUE(time.too_early(-5ms, 500us));
  EXPECT_FALSE(time.too_early(0ms, 500us));
  time.learn(-4ms);
  EXPECT_TRUE(time.too_early(-5ms, 500us)) << "that one may have been another master's";
  time.learn(-4ms);
  EXPECT_FALSE(time.too_early(-5ms, 500us)) << "this line does not keep to its baud rate";
}

}  // namespace
}  // namespace fieldcast
