#include "tools/station/notify/hours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <iterator>

namespace fieldcast::web {
namespace {

constexpr int kDay = 24 * 60;
constexpr std::string_view kDays[] = {"mon", "tue", "wed", "thu", "fri", "sat", "sun"};

std::optional<int> day_from(std::string_view text) {
  const auto* const found = std::find(std::begin(kDays), std::end(kDays), text);
  if (found == std::end(kDays)) return std::nullopt;
  return static_cast<int>(found - std::begin(kDays));
}

// "fri-mon" is Friday to Monday.
std::optional<std::uint8_t> days_from(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto first = day_from(text.substr(0, dash));
  const auto last = dash == text.npos ? first : day_from(text.substr(dash + 1));
  if (!first || !last) return std::nullopt;
  unsigned days = 0;
  for (int day = *first;; day = (day + 1) % 7) {
    days |= 1u << day;
    if (day == *last) return static_cast<std::uint8_t>(days);
  }
}

// "06:00"; "24:00" is the end of the day.
std::optional<int> minute_from(std::string_view text) {
  const auto digit = [&](std::size_t at) {
    return text[at] >= '0' && text[at] <= '9' ? text[at] - '0' : 1000;
  };
  if (text.size() != 5 || text[2] != ':') return std::nullopt;
  const int hour = 10 * digit(0) + digit(1), minute = 10 * digit(3) + digit(4);
  if (hour > 24 || minute > 59 || 60 * hour + minute > kDay) return std::nullopt;
  return 60 * hour + minute;
}

bool read_times(std::string_view text, HoursSpan& span) {
  const std::size_t dash = text.find('-');
  if (dash == text.npos) return false;
  const auto from = minute_from(text.substr(0, dash)), to = minute_from(text.substr(dash + 1));
  if (!from || !to || *from == kDay) return false;
  span.from = *from;
  span.to = *to;
  return true;
}

}  // namespace

LocalMinute local_minute(UtcTime at) {
  const std::time_t seconds = at.nanoseconds / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return {(local.tm_wday + 6) % 7, 60 * local.tm_hour + local.tm_min};
}

bool HoursSpan::contains(const LocalMinute& at) const {
  const auto on = [this](int day) { return (days >> day & 1) != 0; };
  if (from < to) return on(at.weekday) && at.minute >= from && at.minute < to;
  return (on(at.weekday) && at.minute >= from) || (on((at.weekday + 6) % 7) && at.minute < to);
}

std::optional<HoursSpan> hours_from(std::string_view text) {
  HoursSpan span;
  const std::size_t space = text.find(' ');
  const auto days = days_from(text.substr(0, space));
  if (!days)
    return space == text.npos && read_times(text, span) ? std::optional(span) : std::nullopt;
  span.days = *days;
  if (space != text.npos && !read_times(text.substr(space + 1), span)) return std::nullopt;
  return span;
}

std::string to_text(const HoursSpan& span) {
  constexpr unsigned kEveryDay = 0x7f;
  const auto on = [&](int day) { return (span.days >> day % 7 & 1) != 0; };
  int first = 0;
  while (first < 7 && !(on(first) && !on(first + 6))) ++first;
  int last = first;
  while (last < first + 6 && on(last + 1)) ++last;
  std::string days = span.days == kEveryDay ? "" : std::string(kDays[first % 7]);
  if (last > first && !days.empty()) days += '-' + std::string(kDays[last % 7]);
  const bool is_whole_day = span.from == 0 && span.to == kDay;
  if (is_whole_day) return days.empty() ? "mon-sun" : days;
  const std::string times = fmt::format("{:02}:{:02}-{:02}:{:02}", span.from / 60, span.from % 60,
                                        span.to / 60, span.to % 60);
  return days.empty() ? times : days + ' ' + times;
}

bool in_hours(std::span<const HoursSpan> spans, const LocalMinute& at) {
  return spans.empty() || std::any_of(spans.begin(), spans.end(),
                                      [&](const auto& each) { return each.contains(at); });
}

}  // namespace fieldcast::web
