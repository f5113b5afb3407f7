#include <gmock/gmock.h>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr UtcTime kRaisedAt{1'700'000'000'000'000'000};
UtcTime later(std::chrono::minutes minutes) {
  return {kRaisedAt.nanoseconds + Duration(minutes).count()};
}

AlarmKey key_of(const std::string& channel) { return {"b", "d", channel, LimitKind::kHighHigh}; }

KnownAlarm raised(AlarmStage stage, AlarmPriority priority = AlarmPriority::kHigh) {
  AlarmStatus status;
  status.stage = stage;
  status.active = stage == AlarmStage::kUnacknowledged || stage == AlarmStage::kAcknowledged;
  status.priority = priority;
  status.value = 91.25;
  status.raised_at = kRaisedAt;
  if (!status.active) status.cleared_at = kRaisedAt;
  return {{}, status};
}

TEST(AlarmView, ShowsFirstWhatWaitsForAPerson) {
  KnownAlarms alarms;
  alarms[key_of("clear")] = raised(AlarmStage::kClear);
  alarms[key_of("a-low")] = raised(AlarmStage::kUnacknowledged, AlarmPriority::kLow);
  alarms[key_of("critical")] = raised(AlarmStage::kUnacknowledged, AlarmPriority::kCritical);
  alarms[key_of("b-returned")] = raised(AlarmStage::kReturned);
  alarms[key_of("b-seen")] = raised(AlarmStage::kAcknowledged);
  alarms[key_of("b-seen")].status->acknowledged = {"anna", "on my\x1b way",
                                                   later(std::chrono::minutes{1})};
  alarms[key_of("a-shelved")] = raised(AlarmStage::kUnacknowledged);
  alarms[key_of("a-shelved")].status->shelved = {"bert", "", kRaisedAt,
                                                 later(std::chrono::minutes{30})};
  alarms[key_of("older-bridge")].alarm = StationAlarm{
      "b", "d", "older-bridge", LimitKind::kHighHigh, AlarmState::kActive, 5, kRaisedAt};
  const auto lines = alarm_lines(alarms, later(std::chrono::minutes{10}), {});
  ASSERT_EQ(lines.size(), 7u) << "titles, and what is not clear";
  EXPECT_THAT(lines[1], AllOf(HasSubstr("b/d/critical"), HasSubstr("high-high"), HasSubstr("91.25"),
                              HasSubstr("unacknowledged"), HasSubstr("10 min")));
  EXPECT_THAT(lines[2], AllOf(HasSubstr("older-bridge"), HasSubstr("active")));
  EXPECT_THAT(lines[3], HasSubstr("a-low"));
  EXPECT_THAT(lines[4], AllOf(HasSubstr("b-returned"), HasSubstr("returned")));
  EXPECT_THAT(lines[5], AllOf(HasSubstr("b-seen"), HasSubstr("anna: on my\\x1B way")));
  EXPECT_THAT(lines[6],
              AllOf(HasSubstr("a-shelved"), HasSubstr("shelved, 20 min more"), HasSubstr("bert")));
}

TEST(AlarmView, JsonHasWhatBothTopicsSay) {
  KnownAlarm known = raised(AlarmStage::kAcknowledged);
  known.status->acknowledged = {"anna", "seen", {5}};
  known.status->suppressed = {"chen", "", {6}, {7}};
  const auto json = parsed(alarm_json(key_of("c"), known));
  EXPECT_EQ(json["state"], "active");
  EXPECT_EQ(json["stage"], "acknowledged");
  EXPECT_EQ(json["priority"], "high");
  EXPECT_EQ(json["acknowledged_by"], "anna");
  EXPECT_EQ(json["suppressed_until"], 7);
  EXPECT_FALSE(json.contains("shelved_by"));
  const StationAlarm older{"b", "d", "c", LimitKind::kLow, AlarmState::kClear, 5, {9}};
  EXPECT_EQ(alarm_json({"b", "d", "c", LimitKind::kLow}, {older, {}}).text(),
            R"({"bus":"b","device":"d","channel":"c","limit":"low","state":"clear",)"
            R"("value":5.0,"since":9})");
}

TEST(AlarmView, TheHistorySaysWhoAndUntilWhen) {
  AlarmLogEntry entry{"b", "d", "c", "high", "raised", 91.5, "", "", kRaisedAt, {}};
  EXPECT_EQ(alarm_line(entry), "2023-11-14T22:13:20.000Z  b/d/c  high raised  91.5");
  EXPECT_EQ(parsed(record_json(entry))["state"], "active");
  entry = {"b", "d",    "",    "",        "maintenance",
           {},  "anna", "oil", kRaisedAt, later(std::chrono::minutes{1})};
  EXPECT_EQ(
      alarm_line(entry),
      "2023-11-14T22:13:20.000Z  b/d  maintenance by anna until 2023-11-14T22:14:20.000Z: oil");
  EXPECT_EQ(parsed(record_json(entry))["who"], "anna");
  EXPECT_FALSE(parsed(record_json(entry)).contains("state"));
}

}  // namespace
}  // namespace fieldcast::cli
