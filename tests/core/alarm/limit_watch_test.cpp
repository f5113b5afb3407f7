#include <gtest/gtest.h>

#include <cmath>

#include "core/alarm/alarm_monitor.hpp"
#include "core/alarm/alarm_status.hpp"

namespace fieldcast {
namespace {

using std::chrono::seconds;

Instant at(int second) { return Instant{seconds{1000 + second}}; }

// One value per second: 'R' raised, 'C' cleared, '.' unchanged. NaN: not good.
std::string changes(LimitWatch& watch, const std::vector<double>& values, int from = 0) {
  std::string changes;
  for (const double value : values) {
    bool changed = false;
    if (std::isnan(value)) {
      watch.on_bad();
      changed = watch.on_time(at(from));
    } else {
      changed = watch.on_good(value, at(from), at(from));
    }
    changes += !changed ? '.' : watch.state() == AlarmState::kActive ? 'R' : 'C';
    ++from;
  }
  return changes;
}

constexpr double kBad = std::numeric_limits<double>::quiet_NaN();

TEST(LimitWatch, RaisesAboveAHighLimitAndClearsAtIt) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, {});
  EXPECT_EQ(changes(watch, {89, 90, 90.5, 95, 90, 91}), "..R.CR");
}

TEST(LimitWatch, RaisesBelowALowLimitAndClearsAtIt) {
  LimitWatch watch(LimitKind::kLowLow, -5, 0, {});
  EXPECT_EQ(changes(watch, {-4, -5, -5.5, -6, -5}), "..R.C");
}

TEST(LimitWatch, ClearsOnlyWhenBackInsideByTheHysteresis) {
  LimitWatch high(LimitKind::kHighHigh, 90, 2, {});
  EXPECT_EQ(changes(high, {91, 89, 91, 88.5, 88, 90.5}), "R...CR");
  LimitWatch low(LimitKind::kLow, 10, 2, {});
  EXPECT_EQ(changes(low, {9, 11, 11.5, 12, 10.5}), "R..C.");
}

TEST(LimitWatch, WaitsForTheDelayAndForgetsWhatWasShorter) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, seconds{3});
  EXPECT_EQ(changes(watch, {91, 92, 89, 91, 91, 91, 93}), "......R");
  EXPECT_EQ(watch.since(), at(3)) << "the first value beyond";
  EXPECT_EQ(watch.value(), 93);
}

TEST(LimitWatch, EachOccurrenceWaitsForTheDelay) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, seconds{3});
  EXPECT_EQ(changes(watch, {91, 91, 91, 91, 89, 91, 91, 91, 92}), "...RC...R");
  EXPECT_EQ(watch.since(), at(5));
  EXPECT_EQ(watch.value(), 92);
}

TEST(LimitWatch, AnAlarmOfBeforeGoesOnWithItsOwnBeginningUntilAGoodValueEndsIt) {
  LimitWatch high(LimitKind::kHigh, 90, 2, seconds{3});
  high.restore(93, at(-500));
  EXPECT_EQ(high.state(), AlarmState::kActive);
  EXPECT_EQ(high.since(), at(-500));
  EXPECT_EQ(high.value(), 93);
  EXPECT_EQ(changes(high, {kBad, 95, 89, 88}), "...C");
  EXPECT_EQ(high.since(), at(3));
}

TEST(LimitWatch, WhatIsRestoredLateHeedsTheValuesThatCameBefore) {
  LimitWatch inside(LimitKind::kHigh, 90, 2, {}), near(LimitKind::kHigh, 90, 2, {}),
      raised(LimitKind::kHigh, 90, 2, {});
  EXPECT_EQ(changes(inside, {70}), ".");
  inside.restore(93, at(-500));
  EXPECT_EQ(inside.state(), AlarmState::kClear);
  EXPECT_EQ(inside.value(), 70);
  EXPECT_EQ(inside.since(), at(0));
  EXPECT_EQ(changes(near, {89}), ".");  // within the hysteresis: the alarm has not ended
  near.restore(93, at(-500));
  EXPECT_EQ(near.state(), AlarmState::kActive);
  EXPECT_EQ(changes(raised, {91, 92}), "R.");
  raised.restore(93, at(-500));
  EXPECT_EQ(raised.state(), AlarmState::kActive);
  EXPECT_EQ(raised.since(), at(-500));
}

TEST(LimitWatch, RaisesByTimeAloneWhenAValueDoesNotChange) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, seconds{3});
  EXPECT_FALSE(watch.on_good(91, at(0), at(0)));
  EXPECT_FALSE(watch.on_time(at(2)));
  EXPECT_TRUE(watch.on_time(at(3)));
  EXPECT_FALSE(watch.on_time(at(4))) << "once";
  EXPECT_EQ(watch.state(), AlarmState::kActive);
}

TEST(LimitWatch, BadValuesNeitherRaiseNorClear) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, {});
  EXPECT_EQ(changes(watch, {kBad, 91, kBad, kBad, 89, kBad}), ".R..C.");
}

TEST(LimitWatch, ADelayGoesOnOverBadValuesButAGoodOneEndsIt) {
  LimitWatch still_beyond(LimitKind::kHigh, 90, 0, seconds{3});
  EXPECT_EQ(changes(still_beyond, {91, kBad, kBad, kBad, kBad, 92}), ".....R");
  EXPECT_EQ(still_beyond.since(), at(0));
  LimitWatch back(LimitKind::kHigh, 90, 0, seconds{3});
  EXPECT_EQ(changes(back, {91, kBad, kBad, kBad, kBad, 89, 91}), ".......");
}

TEST(LimitWatch, NotANumberIsNotGood) {
  LimitWatch watch(LimitKind::kHigh, 90, 0, seconds{1});
  EXPECT_FALSE(watch.on_good(91, at(0), at(0)));
  EXPECT_FALSE(watch.on_good(std::nan(""), at(1), at(1)));
  EXPECT_FALSE(watch.on_time(at(5)));
  EXPECT_TRUE(watch.on_good(91, at(6), at(6)));
  EXPECT_FALSE(watch.on_good(std::nan(""), at(7), at(7)));
  EXPECT_EQ(watch.state(), AlarmState::kActive);
}

BusSpec plant() {
  BusSpec bus;
  bus.name = "bus";
  DeviceSpec device;
  device.name = "device";
  for (const char* name : {"free", "limited", "text", "other"}) {
    ChannelSpec channel;
    channel.name = name;
    if (channel.name == "limited")
      channel.limits = {.low_low = {}, .low = 10, .high = 90, .high_high = 95};
    if (channel.name == "other") channel.limits.high = 1;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

Sample sample(ChannelIndex channel, Value value, Quality quality = Quality::kGood) {
  return {.channel = channel, .value = std::move(value), .quality = quality, .acquired = at(0)};
}

TEST(AlarmMonitor, ReportsEveryLimitThatAValuePasses) {
  AlarmMonitor monitor(plant());
  std::vector<AlarmChange> changes;
  const Sample over[] = {sample(0, 1e9), sample(1, 96.0), sample(3, std::int64_t{2})};
  monitor.on_samples(over, at(0), changes);
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].channel, 1u);
  EXPECT_EQ(changes[0].limit, LimitKind::kHigh);
  EXPECT_EQ(changes[1].limit, LimitKind::kHighHigh);
  EXPECT_EQ(changes[1].state, AlarmState::kActive);
  EXPECT_EQ(changes[2].channel, 3u);
  EXPECT_EQ(changes[2].value, 2.0);
  changes.clear();
  const Sample back[] = {sample(1, 92.0)};
  monitor.on_samples(back, at(1), changes);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].limit, LimitKind::kHighHigh);
  EXPECT_EQ(changes[0].state, AlarmState::kClear);
}

TEST(AlarmMonitor, OnlyGoodQualityCounts) {
  AlarmMonitor monitor(plant());
  std::vector<AlarmChange> changes;
  for (int i = 1; i <= static_cast<int>(Quality::kNotYetRead); ++i) {
    const Sample bad[] = {sample(1, 99.0, static_cast<Quality>(i))};
    monitor.on_samples(bad, at(i), changes);
    EXPECT_TRUE(changes.empty()) << to_text(static_cast<Quality>(i));
  }
}

TEST(AlarmMonitor, OnlyANumberCounts) {
  AlarmMonitor monitor(plant());
  std::vector<AlarmChange> changes;
  const Sample values[] = {sample(1, 99.0), sample(1, std::string("50"))};
  monitor.on_samples(values, at(0), changes);
  ASSERT_EQ(changes.size(), 2u);
  for (const AlarmChange& change : changes) EXPECT_EQ(change.state, AlarmState::kActive);
}

TEST(AlarmMonitor, AnAlarmOfBeforeContinuesAtItsLimit) {
  AlarmMonitor monitor(plant());
  std::vector<AlarmChange> changes;
  monitor.restore({1, LimitKind::kHigh, AlarmState::kActive, 93, at(-500)}, changes);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].channel, 1u);
  EXPECT_EQ(changes[0].limit, LimitKind::kHigh);
  EXPECT_EQ(changes[0].state, AlarmState::kActive);
  EXPECT_EQ(changes[0].value, 93);
  EXPECT_EQ(changes[0].since, at(-500));
  changes.clear();
  const Sample inside[] = {sample(1, 50.0)};
  monitor.on_samples(inside, at(1), changes);
  ASSERT_EQ(changes.size(), 1u) << "the other limits were clear";
  EXPECT_EQ(changes[0].limit, LimitKind::kHigh);
  EXPECT_EQ(changes[0].state, AlarmState::kClear);
}

TEST(AlarmMonitor, AnAlarmOfALimitThatIsNotConfiguredDoesNotContinue) {
  AlarmMonitor monitor(plant());
  std::vector<AlarmChange> changes;
  monitor.restore({0, LimitKind::kHigh, AlarmState::kActive, 93, at(-500)}, changes);
  monitor.restore({1, LimitKind::kLowLow, AlarmState::kActive, 1, at(-500)}, changes);
  EXPECT_TRUE(changes.empty());
}

TEST(AlarmMonitor, DelaysEndWithTime) {
  BusSpec bus = plant();
  bus.devices[0].channels[1].limits.delay = seconds{5};
  AlarmMonitor monitor(bus);
  std::vector<AlarmChange> changes;
  const Sample over[] = {sample(1, 91.0)};
  monitor.on_samples(over, at(0), changes);
  monitor.on_time(at(4), changes);
  EXPECT_TRUE(changes.empty());
  monitor.on_time(at(5), changes);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].since, at(0));
}

}  // namespace
}  // namespace fieldcast
