// Totals of a channel by shift, day or month in local time, from its minutes. Pure.
#pragma once

#include <ctime>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/tiers/bucket.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

inline constexpr Duration kReportMinute = std::chrono::minutes{1};
inline constexpr const char* kReportColumns[] = {"channel", "unit", "from",     "to",     "min",
                                                 "mean",    "max",  "integral", "covered"};

// In the time zone of the process.
[[nodiscard]] std::tm local_parts(UtcTime at);
// A minute of a day of a local month; days and months beyond the last one are in the next one.
[[nodiscard]] UtcTime local_moment(const std::tm& month, int day, int minute);

enum class ReportBy : std::uint8_t { kShift, kDay, kMonth };
// "shift", "day", "month"
[[nodiscard]] std::optional<ReportBy> report_by(std::string_view text);
[[nodiscard]] std::string_view to_text(ReportBy by);

// "06:00,14:00,22:00" as minutes of the day in increasing order, 1 to 12; otherwise empty.
[[nodiscard]] std::vector<int> shifts_from(std::string_view text);

struct ReportPeriod {
  UtcTime from, to;
  friend bool operator==(const ReportPeriod&, const ReportPeriod&) = default;
};
// The whole periods that contain a part of from <= time < to, at most `most`; by the time zone of
// the process. `shifts` are the starts of the shifts. REQUIRES: from < to.
[[nodiscard]] std::vector<ReportPeriod> periods_of(UtcTime from, UtcTime to, ReportBy by,
                                                   std::span<const int> shifts, std::size_t most);

struct ReportRow {
  ReportPeriod period;
  double covered = 0;  // share of the minutes of the period with a good sample
  // Empty if no minute is covered.
  std::optional<double> min, mean, max, integral;
};
// `minutes`: buckets of kReportMinute in the order of time. REQUIRES: periods in that order too.
[[nodiscard]] std::vector<ReportRow> report_rows(std::span<const Bucket> minutes,
                                                 std::span<const ReportPeriod> periods);

struct ReportTable {
  std::string channel, unit;
  bool known = false;
  std::vector<ReportRow> rows;
};
[[nodiscard]] std::string report_csv(const std::vector<ReportTable>& tables);

}  // namespace fieldcast::web
