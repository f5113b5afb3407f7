#include "tools/station/report/report.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <ctime>

namespace fieldcast::web {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

UtcTime at(std::int64_t unix_seconds) { return {unix_seconds * 1'000'000'000}; }

constexpr std::int64_t kHour = 3600, kDay = 24 * kHour;
constexpr std::int64_t kMarch29 = 1'774'738'800;  // 2026-03-29 00:00 in Central Europe, 23:00 UTC

class Report : public testing::Test {
 protected:
  Report() {
    ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
    ::tzset();
  }
  ~Report() override {
    ::unsetenv("TZ");
    ::tzset();
  }
};

Bucket minute(std::int64_t unix_seconds, double value) {
  return {
      .start = at(unix_seconds), .count = 2, .min = value - 1, .max = value + 1, .sum = 2 * value};
}

TEST_F(Report, DaysFollowTheLocalClockOverDaylightSaving) {
  EXPECT_THAT(periods_of(at(kMarch29 + 60), at(kMarch29 + kDay), ReportBy::kDay, {}, 10),
              ElementsAre(ReportPeriod{at(kMarch29), at(kMarch29 + 23 * kHour)},
                          ReportPeriod{at(kMarch29 + 23 * kHour), at(kMarch29 + 47 * kHour)}));
}

TEST_F(Report, ANightShiftBeginsOnTheDayBefore) {
  const auto shifts = shifts_from("06:00,14:00,22:00");
  const auto periods = periods_of(at(kMarch29), at(kMarch29 + kHour), ReportBy::kShift, shifts, 10);
  // 22:00 to 06:00 is seven hours in this night.
  EXPECT_THAT(periods,
              ElementsAre(ReportPeriod{at(kMarch29 - 2 * kHour), at(kMarch29 + 5 * kHour)}));
}

TEST_F(Report, MonthsAndLimits) {
  const auto months = periods_of(at(kMarch29), at(kMarch29 + 70 * kDay), ReportBy::kMonth, {}, 10);
  ASSERT_THAT(months, SizeIs(4));
  EXPECT_EQ(months[0].from, at(kMarch29 - 28 * kDay));
  EXPECT_EQ(months[0].to, months[1].from);
  EXPECT_THAT(periods_of(at(0), at(kMarch29), ReportBy::kDay, {}, 5), SizeIs(5));
}

TEST_F(Report, ShiftsAreTimesInOrder) {
  EXPECT_THAT(shifts_from("06:00,14:30"), ElementsAre(360, 870));
  for (const char* text : {"", "06:00,", "6:00", "14:00,06:00", "06:00,06:00", "24:00", "06:60",
                           "06:00;14:00", "06:00,14:0", "0a:00"})
    EXPECT_THAT(shifts_from(text), IsEmpty()) << text;
}

TEST_F(Report, TheIntegralIsTheEnergyOfAPower) {
  std::vector<Bucket> minutes;
  for (int i = 0; i < 30; ++i) minutes.push_back(minute(60 * i, 12));   // 12 kW for half an hour
  for (int i = 30; i < 45; ++i) minutes.push_back(minute(60 * i, 24));  // 24 kW for a quarter
  minutes.push_back({.start = at(60 * 45), .bad = 5});                  // not counted
  minutes.push_back(minute(kHour, 1000));                               // of the next period
  const ReportPeriod periods[] = {
      {at(0), at(kHour)}, {at(kHour), at(2 * kHour)}, {at(2 * kHour), at(3 * kHour)}};
  const auto rows = report_rows(minutes, periods);
  ASSERT_THAT(rows, SizeIs(3));
  EXPECT_DOUBLE_EQ(*rows[0].integral, 12.0);  // kWh
  EXPECT_DOUBLE_EQ(*rows[0].mean, 16);
  EXPECT_EQ(rows[0].min, 11);
  EXPECT_EQ(rows[0].max, 25);
  EXPECT_DOUBLE_EQ(rows[0].covered, 0.75);
  EXPECT_EQ(rows[1].max, 1001);
  EXPECT_FALSE(rows[2].mean);
  EXPECT_EQ(rows[2].covered, 0);
}

TEST_F(Report, CsvHasARowForEachPeriodAndQuotesNames) {
  ReportTable table{.channel = "line/press/p", .unit = "=1+1", .known = true};
  table.rows = {{.period = {at(kMarch29), at(kMarch29 + kHour)},
                 .covered = 0.5,
                 .min = 1,
                 .mean = 2.5,
                 .max = 4,
                 .integral = 1.25},
                {.period = {at(kMarch29 + kHour), at(kMarch29 + 2 * kHour)}}};
  EXPECT_EQ(report_csv({table}),
            "channel,unit,from,to,min,mean,max,integral,covered\n"
            "line/press/p,'=1+1,2026-03-29T00:00:00+0100,2026-03-29T01:00:00+0100,"
            "1,2.5,4,1.25,0.5000\n"
            "line/press/p,'=1+1,2026-03-29T01:00:00+0100,2026-03-29T03:00:00+0200,"
            ",,,,0.0000\n");
}

}  // namespace
}  // namespace fieldcast::web
