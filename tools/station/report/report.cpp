#include "tools/station/report/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "core/base/csv_field.hpp"

namespace fieldcast::web {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kMaxShifts = 12;

// Starts of periods from one before `from` to one at or after `to`, at most `most`.
std::vector<UtcTime> starts_of(UtcTime from, UtcTime to, ReportBy by, std::span<const int> shifts,
                               std::size_t most) {
  static constexpr int kMidnight[] = {0};
  std::tm month = local_parts(from);
  std::vector<UtcTime> starts;
  if (by == ReportBy::kMonth) {
    do {
      starts.push_back(local_moment(month, 1, 0));
      ++month.tm_mon;
    } while (starts.back() < to && starts.size() < most);
    return starts;
  }
  const std::span<const int> minutes = by == ReportBy::kShift ? shifts : std::span(kMidnight);
  for (int day = month.tm_mday - 1;; ++day) {
    for (const int minute : minutes) {
      starts.push_back(local_moment(month, day, minute));
      if (starts.back() >= to || starts.size() >= most) return starts;
    }
  }
}

void append_number(std::string& out, const std::optional<double>& number) {
  out += ',';
  if (number) out += fmt::format("{}", *number);
}

std::string csv_time(UtcTime at) {
  const std::tm parts = local_parts(at);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", parts);
}

}  // namespace

std::tm local_parts(UtcTime at) {
  const std::time_t seconds = at.nanoseconds / kSecond;
  std::tm parts{};
  ::localtime_r(&seconds, &parts);
  return parts;
}

UtcTime local_moment(const std::tm& month, int day, int minute) {
  std::tm parts{};
  parts.tm_year = month.tm_year;
  parts.tm_mon = month.tm_mon;
  parts.tm_mday = day;
  parts.tm_min = minute;
  parts.tm_isdst = -1;
  return {std::int64_t{::mktime(&parts)} * kSecond};
}

std::string_view to_text(ReportBy by) {
  switch (by) {
    case ReportBy::kShift: return "shift";
    case ReportBy::kDay: return "day";
    case ReportBy::kMonth: break;
  }
  return "month";
}

std::optional<ReportBy> report_by(std::string_view text) {
  for (const ReportBy by : {ReportBy::kShift, ReportBy::kDay, ReportBy::kMonth}) {
    if (text == to_text(by)) return by;
  }
  return std::nullopt;
}

std::vector<int> shifts_from(std::string_view text) {
  std::vector<int> shifts;
  for (; text.size() >= 5 && shifts.size() < kMaxShifts; text.remove_prefix(1)) {
    const auto digits = [&](std::size_t at) {
      const bool good =
          text[at] >= '0' && text[at] <= '9' && text[at + 1] >= '0' && text[at + 1] <= '9';
      return good ? 10 * (text[at] - '0') + text[at + 1] - '0' : 99;
    };
    const int minute = 60 * digits(0) + digits(3);
    if (text[2] != ':' || digits(0) > 23 || digits(3) > 59 ||
        (!shifts.empty() && minute <= shifts.back()))
      return {};
    shifts.push_back(minute);
    text.remove_prefix(5);
    if (text.empty()) return shifts;
    if (text.front() != ',') return {};
  }
  return {};
}

std::vector<ReportPeriod> periods_of(UtcTime from, UtcTime to, ReportBy by,
                                     std::span<const int> shifts, std::size_t most) {
  // Two days of shifts may be before the first period.
  const auto starts = starts_of(from, to, by, shifts, most + 2 * kMaxShifts + 2);
  std::vector<ReportPeriod> periods;
  for (std::size_t i = 0; i + 1 < starts.size() && periods.size() < most; ++i) {
    if (starts[i + 1] > from && starts[i] < to) periods.push_back({starts[i], starts[i + 1]});
  }
  return periods;
}

std::vector<ReportRow> report_rows(std::span<const Bucket> minutes,
                                   std::span<const ReportPeriod> periods) {
  std::vector<ReportRow> rows;
  auto at = minutes.begin();
  for (const ReportPeriod& period : periods) {
    ReportRow& row = rows.emplace_back(ReportRow{.period = period});
    double sum = 0;
    std::int64_t count = 0;
    while (at != minutes.end() && at->start < period.from) ++at;
    for (; at != minutes.end() && at->start < period.to; ++at) {
      const auto average = at->average();
      if (!average) continue;
      sum += *average;
      ++count;
      row.min = std::min(row.min.value_or(at->min), at->min);
      row.max = std::max(row.max.value_or(at->max), at->max);
    }
    const auto whole = (period.to.nanoseconds - period.from.nanoseconds) / kReportMinute.count();
    if (whole > 0) row.covered = static_cast<double>(count) / static_cast<double>(whole);
    if (count == 0) continue;
    row.mean = sum / static_cast<double>(count);
    row.integral = sum / 60;
  }
  return rows;
}

std::string report_csv(const std::vector<ReportTable>& tables) {
  std::string out = fmt::format("{}\n", fmt::join(kReportColumns, ","));
  for (const ReportTable& table : tables) {
    for (const ReportRow& row : table.rows) {
      out += csv_field(table.channel) + ',' + csv_field(table.unit) + ',' +
             csv_time(row.period.from) + ',' + csv_time(row.period.to);
      for (const auto& number : {row.min, row.mean, row.max, row.integral})
        append_number(out, number);
      out += fmt::format(",{:.4f}\n", row.covered);
    }
  }
  return out;
}

}  // namespace fieldcast::web
