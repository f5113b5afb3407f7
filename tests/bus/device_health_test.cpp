#include "core/bus/health/device_health.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(DeviceHealth, SilenceTakesItOffline) {
  DeviceHealth health;
  EXPECT_TRUE(health.answered());
  EXPECT_TRUE(health.failed(Cause::kNoAnswer, Instant{1s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  EXPECT_TRUE(health.failed(Cause::kNoAnswer, Instant{2s}));
  EXPECT_TRUE(health.offline());
}

TEST(DeviceHealth, BrokenAnswersShowThatSomebodyIsThere) {
  DeviceHealth health;
  (void)health.answered();
  for (int i = 0; i < 100; ++i) (void)health.failed(Cause::kChecksum, Instant{1s});
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
}

TEST(DeviceHealth, WhatAnswersBrokenFromTheBeginningIsNotUnknown) {
  DeviceHealth health;
  EXPECT_TRUE(health.failed(Cause::kForeign, Instant{1s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  DeviceHealth silent;
  EXPECT_FALSE(silent.failed(Cause::kNoAnswer, Instant{1s}));
  EXPECT_EQ(silent.state(), DeviceState::kUnknown);
}

// Busy is a temporary state, unless it lasts long without any other response.
TEST(DeviceHealth, ADeviceThatStaysBusyGoesOffline) {
  DeviceHealth health;
  (void)health.answered();
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{1s})) << "one answer shows little";
  EXPECT_TRUE(health.failed(Cause::kDeviceBusy, Instant{2s}));
  EXPECT_EQ(health.state(), DeviceState::kDegraded);
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{10s}));
  EXPECT_TRUE(health.failed(Cause::kDeviceBusy, Instant{1s} + DeviceHealth::kBusyToOffline));
  EXPECT_TRUE(health.offline());
  EXPECT_TRUE(health.answered());
  EXPECT_FALSE(health.failed(Cause::kDeviceBusy, Instant{20s})) << "the time begins again";
  EXPECT_EQ(health.state(), DeviceState::kOnline);
}

TEST(DeviceHealth, IsProbedEverMoreRarely) {
  DeviceHealth health;
  Instant now{};
  for (unsigned i = 0; i < DeviceHealth::kFailuresToOffline; ++i)
    (void)health.failed(Cause::kNoAnswer, now);
  Duration before{};
  for (int i = 0; i < 10; ++i) {
    const Duration interval = health.probe_at() - now;
    EXPECT_GE(interval, before);
    EXPECT_LE(interval, DeviceHealth::kLastProbe);
    before = interval;
    now = health.probe_at();
    EXPECT_FALSE(health.failed(Cause::kNoAnswer, now)) << "no news";
  }
  EXPECT_EQ(before, DeviceHealth::kLastProbe);
}

TEST(DeviceHealth, OneAnswerBringsItBack) {
  DeviceHealth health;
  for (int i = 0; i < 5; ++i) (void)health.failed(Cause::kNoAnswer, Instant{1s});
  EXPECT_TRUE(health.answered());
  EXPECT_EQ(health.state(), DeviceState::kOnline);
  EXPECT_EQ(health.probe_at(), kNever);
  EXPECT_FALSE(health.answered());
}

}  // namespace
}  // namespace fieldcast
