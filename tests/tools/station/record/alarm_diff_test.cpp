#include <gtest/gtest.h>

#include "tools/station/record/recorder.hpp"

namespace fieldcast::web {
namespace {

constexpr UtcTime second(std::int64_t count) {
  return {1'700'000'000'000'000'000 + count * 1'000'000'000};
}

StationAlarmStatus raised(std::int64_t at, const std::string& channel = "level") {
  StationAlarmStatus alarm;
  alarm.alarm = {"line", "press", channel, LimitKind::kHigh};
  alarm.status.stage = AlarmStage::kUnacknowledged;
  alarm.status.active = true;
  alarm.status.value = 101;
  alarm.status.raised_at = second(at);
  return alarm;
}

TEST(AlarmDiff, AnAlarmThatIsRaisedAndClearedIsTwoRecords) {
  AlarmDiff diff;
  StationAlarmStatus alarm = raised(1);
  AlarmNews news = diff.next(alarm, second(2));
  ASSERT_EQ(news.records.size(), 1u);
  EXPECT_EQ(news.records[0].state, "active");
  EXPECT_EQ(news.records[0].limit, "high");
  EXPECT_EQ(news.records[0].since, second(1));
  EXPECT_EQ(news.kept.size(), 1u);
  alarm.status.active = false;
  alarm.status.stage = AlarmStage::kReturned;
  alarm.status.value = 95;
  alarm.status.cleared_at = second(5);
  news = diff.next(alarm, second(5));
  ASSERT_EQ(news.records.size(), 1u);
  EXPECT_EQ(news.records[0].state, "clear");
  EXPECT_EQ(news.records[0].value, 95);
}

TEST(AlarmDiff, TheSameStatusAgainIsNotReported) {
  AlarmDiff diff;
  (void)diff.next(raised(1), second(2));
  const AlarmNews news = diff.next(raised(1), second(3));
  EXPECT_TRUE(news.records.empty() && news.events.empty() && news.kept.empty());
}

TEST(AlarmDiff, ARestartedRecorderReportsTheSameOfWhatHasItsOwnTime) {
  StationAlarmStatus alarm = raised(1);
  alarm.status.stage = AlarmStage::kAcknowledged;
  alarm.status.acknowledged = {"anna", "seen", second(3)};
  const auto told = [&](std::int64_t received) {
    AlarmDiff diff;
    return diff.next(alarm, second(received));
  };
  EXPECT_EQ(told(4).records, told(400).records);
  EXPECT_EQ(told(4).events, told(400).events);
  ASSERT_EQ(told(4).events.size(), 1u);
  EXPECT_EQ(told(4).events[0].by, "anna");
}

TEST(AlarmDiff, ShelvingEndsByAPersonOrByTime) {
  AlarmDiff diff;
  StationAlarmStatus alarm = raised(1);
  alarm.status.shelved = {"anna", "later", second(2), second(100)};
  ASSERT_EQ(diff.next(alarm, second(2)).events.at(0).kind, AlarmEventKind::kShelved);
  alarm.status.shelved = {};
  EXPECT_EQ(diff.next(alarm, second(50)).events.at(0).kind, AlarmEventKind::kUnshelved);
  alarm.status.shelved = {"anna", "later", second(60), second(100)};
  (void)diff.next(alarm, second(60));
  alarm.status.shelved = {};
  const AlarmEvent ended = diff.next(alarm, second(101)).events.at(0);
  EXPECT_EQ(ended.kind, AlarmEventKind::kShelvingEnded);
  EXPECT_EQ(ended.at, second(100));
}

TEST(AlarmDiff, TheMaintenanceOfADeviceIsReportedOnceForAllItsAlarms) {
  AlarmDiff diff;
  StationAlarmStatus one = raised(1, "level");
  StationAlarmStatus other = raised(1, "speed");
  one.status.suppressed = other.status.suppressed = {"anna", "", second(2), second(100)};
  const AlarmNews first = diff.next(one, second(2));
  ASSERT_EQ(first.events.size(), 1u);
  EXPECT_EQ(first.events[0].alarm.channel, "");
  EXPECT_EQ(first.maintenance.size(), 1u);
  EXPECT_TRUE(diff.next(other, second(2)).events.empty());
  one.status.suppressed = other.status.suppressed = {};
  EXPECT_EQ(diff.next(one, second(10)).events.at(0).kind, AlarmEventKind::kMaintenanceEnded);
  EXPECT_TRUE(diff.next(other, second(10)).events.empty());
}

}  // namespace
}  // namespace fieldcast::web
