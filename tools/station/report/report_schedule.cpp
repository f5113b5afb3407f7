#include "tools/station/report/report_schedule.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::web {
namespace {

constexpr std::size_t kMostRows = 400;  // periods of a run: the shifts of a month

// The run that is due on the day or in the month `back` before the one of `today`.
struct Candidate {
  UtcTime due;
  ReportRun run;
};
Candidate candidate(const ReportSpec& spec, const std::tm& today, int back) {
  std::tm month = today;
  int day = today.tm_mday - back;
  if (spec.monthly) {
    month.tm_mon -= back;
    day = 1;
  }
  std::tm before = month;
  if (spec.monthly) --before.tm_mon;
  const UtcTime from = local_moment(before, spec.monthly ? 1 : day - 1, 0);
  const std::tm named = local_parts(from);
  return {local_moment(month, day, spec.at),
          {spec.monthly ? fmt::format("{:%Y-%m}", named) : fmt::format("{:%Y-%m-%d}", named),
           {from, local_moment(month, day, 0)}}};
}

}  // namespace

std::vector<ReportRun> due_runs(const ReportSpec& spec, std::string_view last, UtcTime now) {
  const std::tm today = local_parts(now);
  const std::size_t most = last.empty() ? 1 : kMostMissed;
  std::vector<ReportRun> runs;
  for (int back = 0; back <= kMostMissed && runs.size() < most; ++back) {
    Candidate each = candidate(spec, today, back);
    if (each.run.period <= last) break;
    if (each.due <= now) runs.push_back(std::move(each.run));
  }
  std::ranges::reverse(runs);
  return runs;
}

std::vector<ReportPeriod> periods_of(const ReportSpec& spec, const ReportRun& run) {
  auto periods = periods_of(run.covers.from, run.covers.to, spec.by, spec.shifts, kMostRows);
  std::erase_if(periods, [&](const ReportPeriod& each) { return each.from < run.covers.from; });
  return periods;
}

std::string report_file_name(const ReportSpec& spec, const ReportRun& run) {
  return fmt::format("{}_{}.{}", spec.name, run.period, spec.csv ? "csv" : "xlsx");
}

}  // namespace fieldcast::web
