#include "tools/station/report/report_schedule.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <ctime>

namespace fieldcast::web {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kMinute = 60, kHourLong = 3600, kDayLong = 24 * kHourLong;
constexpr std::int64_t kNovember29 = 1'795'906'800;  // 2026-11-29 00:00 in Central Europe

class ReportSchedule : public testing::Test {
 protected:
  ReportSchedule() {
    ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
    ::tzset();
  }
  ~ReportSchedule() override {
    ::unsetenv("TZ");
    ::tzset();
  }
  static UtcTime second(std::int64_t unix_seconds) { return {unix_seconds * 1'000'000'000}; }
  static std::vector<std::string> periods(const std::vector<ReportRun>& runs) {
    std::vector<std::string> texts;
    for (const ReportRun& run : runs) texts.push_back(run.period);
    return texts;
  }
};

TEST_F(ReportSchedule, ADayIsReportedOnTheNextDayAtTheTime) {
  const ReportSpec spec{.name = "energy"};  // at 06:10
  const std::int64_t due = kNovember29 + 6 * kHourLong + 10 * kMinute;
  EXPECT_THAT(due_runs(spec, "2026-11-27", second(due - 1)), IsEmpty());
  const auto runs = due_runs(spec, "2026-11-27", second(due));
  ASSERT_THAT(periods(runs), ElementsAre("2026-11-28"));
  EXPECT_EQ(runs[0].covers, (ReportPeriod{second(kNovember29 - kDayLong), second(kNovember29)}));
  EXPECT_THAT(due_runs(spec, "2026-11-28", second(due + kHourLong)), IsEmpty());
  EXPECT_EQ(report_file_name(spec, runs[0]), "energy_2026-11-28.xlsx");
}

TEST_F(ReportSchedule, MissedRunsAreMadeUpInOrderUpToALimit) {
  const ReportSpec spec{.name = "energy"};
  const UtcTime noon = second(kNovember29 + 12 * kHourLong);
  EXPECT_THAT(periods(due_runs(spec, "2026-11-25", noon)),
              ElementsAre("2026-11-26", "2026-11-27", "2026-11-28"));
  EXPECT_THAT(due_runs(spec, "2025-01-01", noon), SizeIs(kMostMissed));
  // A new report begins with the last day.
  EXPECT_THAT(periods(due_runs(spec, "", noon)), ElementsAre("2026-11-28"));
  EXPECT_THAT(periods(due_runs(spec, "", second(kNovember29))), ElementsAre("2026-11-27"));
}

TEST_F(ReportSchedule, ATimeThatGoesBackRepeatsNothing) {
  const ReportSpec spec{.name = "energy"};
  EXPECT_THAT(due_runs(spec, "2026-11-28", second(kNovember29 - 5 * kDayLong)), IsEmpty());
}

TEST_F(ReportSchedule, AMonthIsReportedOnTheFirstOfTheNextOne) {
  const ReportSpec spec{.name = "energy", .monthly = true, .at = 0, .csv = true};
  const std::int64_t december = kNovember29 + 2 * kDayLong;
  EXPECT_THAT(due_runs(spec, "2026-10", second(december - 1)), IsEmpty());
  const auto runs = due_runs(spec, "2026-10", second(december));
  ASSERT_THAT(periods(runs), ElementsAre("2026-11"));
  EXPECT_EQ(runs[0].covers, (ReportPeriod{second(december - 30 * kDayLong), second(december)}));
  EXPECT_THAT(periods_of(spec, runs[0]), SizeIs(30));
  EXPECT_EQ(report_file_name(spec, runs[0]), "energy_2026-11.csv");
  EXPECT_THAT(periods(due_runs(spec, "2025-10", second(december))), SizeIs(13));
}

TEST_F(ReportSchedule, OnThe31stTheMonthBeforeIsStillItsOwn) {
  const ReportSpec spec{.name = "energy", .monthly = true};
  // 2027-03-31 12:00: the months before have no 31st day.
  EXPECT_THAT(periods(due_runs(spec, "2026-12", second(1'806'487'200))),
              ElementsAre("2027-01", "2027-02"));
}

TEST_F(ReportSchedule, TheNightShiftBelongsToTheDayOnWhichItBegins) {
  const ReportSpec spec{.name = "shifts", .by = ReportBy::kShift};
  const auto runs = due_runs(spec, "", second(kNovember29 + 12 * kHourLong));
  ASSERT_THAT(runs, SizeIs(1));
  const std::int64_t day = kNovember29 - kDayLong;
  EXPECT_THAT(
      periods_of(spec, runs[0]),
      ElementsAre(ReportPeriod{second(day + 6 * kHourLong), second(day + 14 * kHourLong)},
                  ReportPeriod{second(day + 14 * kHourLong), second(day + 22 * kHourLong)},
                  ReportPeriod{second(day + 22 * kHourLong), second(day + 30 * kHourLong)}));
}

}  // namespace
}  // namespace fieldcast::web
