#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/cli/parsed_json.hpp"
#include "tools/cli/view/record_view.hpp"
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

const StoredChannel kChannel{1, "press-shop", "press-1", "oil", "°C", "float32"};
const Bucket kMinute{1,  {1'699'999'980'000'000'000}, 3, 1, static_cast<double>(0.1f), 2, 4.1, 1,
                     0.5};
const Bucket kNothingGood{.channel = 1, .start = kMinute.start, .bad = 60};

TEST(BucketView, ShowsTheMeaningOfAPeriod) {
  EXPECT_EQ(bucket_head(Zone::kUtc),
            "time                               min           max       average   count    bad  "
            "channel");
  EXPECT_EQ(bucket_line(kChannel, kMinute, Zone::kUtc),
            "2023-11-14T22:13:00.000Z           0.1             2      1.366667       3      1  "
            "press-shop/press-1/oil (°C)");
  EXPECT_EQ(bucket_line(kChannel, kNothingGood, Zone::kUtc),
            "2023-11-14T22:13:00.000Z             -             -             -       0     60  "
            "press-shop/press-1/oil (°C)");
}

TEST(BucketView, CsvHasEveryDigitAndNothingWhereNothingWasGood) {
  EXPECT_EQ(bucket_csv_head(), "time,min,max,average,count,bad,bus,device,channel,unit");
  EXPECT_EQ(bucket_csv(kChannel, kMinute, Zone::kUtc),
            "2023-11-14T22:13:00.000Z,0.1,2,1.3666666666666665,3,1,press-shop,press-1,oil,°C");
  EXPECT_EQ(bucket_csv(kChannel, kNothingGood, Zone::kUtc),
            "2023-11-14T22:13:00.000Z,,,,0,60,press-shop,press-1,oil,°C");
}

TEST(BucketView, JsonHasNullWhereNothingWasGood) {
  EXPECT_EQ(bucket_json(kChannel, kNothingGood).text(),
            R"({"bus":"press-shop","device":"press-1","channel":"oil","time":1699999980000000000,)"
            R"("min":null,"max":null,"average":null,"count":0,"bad":60})");
  EXPECT_EQ(parsed(bucket_json(kChannel, kMinute))["max"], 2.0);
}

const ProgramSessionReport kSession{
    "press-shop", "press-1",      ProgramSessionState::kOpen, "anna (10.0.0.7:51000)", 1234,
    56789,        {1'000'000'000}};

TEST(SessionsView, ShowsWhoProgramsWhatAndHowMuchWent) {
  const auto lines =
      sessions_lines({{{"press-shop", "press-1"}, kSession}}, UtcTime{2'500'000'000}, {});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[1], AllOf(HasSubstr("press-shop/press-1"), HasSubstr("open"),
                              HasSubstr("anna (10.0.0.7:51000)"), HasSubstr("1234"),
                              HasSubstr("56789"), HasSubstr("1.50 s")));
}

TEST(SessionsView, SaysSoWhenThereIsNone) {
  EXPECT_THAT(sessions_lines({}, {}, {}), testing::ElementsAre("no device has been programmed"));
}

TEST(SessionsView, JsonHasTheFieldsOfTheIdl) {
  static constexpr std::string_view kLine =
      R"j({"bus":"press-shop","device":"press-1","state":"open","who":"anna (10.0.0.7:51000)",)j"
      R"("bytes_to_device":1234,"bytes_from_device":56789,"since":1000000000})";
  EXPECT_EQ(session_json(kSession).text(), kLine);
}

}  // namespace
}  // namespace fieldcast::cli
