#include "tools/station/report/report_xlsx.hpp"

#include <gmock/gmock.h>

#include "tools/import/text/table.hpp"

namespace fieldcast::web {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

UtcTime utc_second(std::int64_t unix_seconds) { return {unix_seconds * 1'000'000'000}; }

// The cells of the first sheet, by the reader that imports lists of points.
std::string cells_of(const std::vector<ReportTable>& tables) {
  const auto bytes = report_xlsx(tables);
  EXPECT_TRUE(bytes) << bytes.error();
  EXPECT_TRUE(importing::is_xlsx(*bytes));
  const auto sheet = importing::table_of_xlsx(*bytes);
  EXPECT_TRUE(sheet);
  return sheet ? sheet->text : "";
}

TEST(ReportXlsx, HasARowForEachPeriodWithNumbersAsNumbers) {
  ::setenv("TZ", "UTC", 1);
  ::tzset();
  ReportTable table{.channel = "line/press/p", .unit = "kW", .known = true};
  table.rows = {{.period = {utc_second(0), utc_second(43'200)},
                 .covered = 0.5,
                 .min = 1,
                 .mean = 2.5,
                 .max = 4,
                 .integral = 1.25},
                {.period = {utc_second(43'200), utc_second(86'400)}}};
  const std::string text = cells_of({table});
  ::unsetenv("TZ");
  ::tzset();
  EXPECT_THAT(text, StartsWith("channel\tunit\tfrom\tto\tmin\tmean\tmax\tintegral\tcovered\t\n"));
  // Times are days since 1899-12-30.
  EXPECT_THAT(text, HasSubstr("\nline/press/p\tkW\t25569\t25569.5\t1\t2.5\t4\t1.25\t0.5\t\n"));
  EXPECT_THAT(text, HasSubstr("\nline/press/p\tkW\t25569.5\t25570\t\t\t\t\t0"));
}

TEST(ReportXlsx, ANameIsATextEvenIfItLooksLikeAFormula) {
  ReportTable table{.channel = "line/press/=1+1", .unit = "=cmd|' /C calc'!A0\x01", .known = true};
  table.rows = {{.period = {utc_second(0), utc_second(60)}}};
  const std::string text = cells_of({table});
  EXPECT_THAT(text, HasSubstr("\nline/press/=1+1\t=cmd|' /C calc'!A0\\x01\t"));
}

TEST(ReportXlsx, WithoutChannelsThereIsTheHead) {
  EXPECT_THAT(cells_of({}), StartsWith("channel\tunit"));
}

}  // namespace
}  // namespace fieldcast::web
