// Which scheduled reports are due. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/station/report/report_spec.hpp"

namespace fieldcast::web {

inline constexpr int kMostMissed = 31;  // runs that are made up after the station was off

struct ReportRun {
  std::string period;  // "2026-11-28" or "2026-11"
  ReportPeriod covers;
};

// The runs that are due at `now`, oldest first: those after the period `last`, at most kMostMissed;
// the newest alone if `last` is empty.
[[nodiscard]] std::vector<ReportRun> due_runs(const ReportSpec& spec, std::string_view last,
                                              UtcTime now);

// The rows of the report. A shift belongs to the day on which it begins.
[[nodiscard]] std::vector<ReportPeriod> periods_of(const ReportSpec& spec, const ReportRun& run);

[[nodiscard]] std::string report_file_name(const ReportSpec& spec, const ReportRun& run);

}  // namespace fieldcast::web
