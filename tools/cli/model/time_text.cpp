#include "tools/cli/model/time_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <ctime>
#include <optional>

#include "core/base/duration_text.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

std::optional<int> take_number(std::string_view& text, std::size_t digits) {
  if (text.size() < digits || text.substr(0, digits).find_first_not_of("0123456789") != text.npos)
    return std::nullopt;
  int number = 0;
  std::from_chars(text.data(), text.data() + digits, number);
  text.remove_prefix(digits);
  return number;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == any_of.npos) return false;
  text.remove_prefix(1);
  return true;
}

std::optional<Duration> take_date(std::string_view& text) {
  namespace chrono = std::chrono;
  const auto year = take_number(text, 4);
  if (!year || !take(text, "-")) return std::nullopt;
  const auto month = take_number(text, 2);
  if (!month || !take(text, "-")) return std::nullopt;
  const auto day = take_number(text, 2);
  if (!day) return std::nullopt;
  const chrono::year_month_day date{chrono::year{*year},
                                    chrono::month{static_cast<unsigned>(*month)},
                                    chrono::day{static_cast<unsigned>(*day)}};
  // limits of 64-bit nanoseconds
  if (!date.ok() || *year < 1970 || *year > 2261) return std::nullopt;
  return Duration{chrono::sys_days{date}.time_since_epoch()};
}

// "10:30", "10:30:05", "10:30:05.25"
std::optional<Duration> take_clock(std::string_view& text) {
  const auto hour = take_number(text, 2);
  if (!hour || *hour > 23 || !take(text, ":")) return std::nullopt;
  const auto minute = take_number(text, 2);
  if (!minute || *minute > 59) return std::nullopt;
  Duration clock = std::chrono::hours{*hour} + std::chrono::minutes{*minute};
  if (!take(text, ":")) return clock;
  const auto second = take_number(text, 2);
  if (!second || *second > 59) return std::nullopt;
  clock += std::chrono::seconds{*second};
  if (!take(text, ".")) return clock;
  std::int64_t worth = 100'000'000;
  bool any = false;
  for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; worth /= 10, any = true) {
    clock += Duration{worth * (text.front() - '0')};
    text.remove_prefix(1);
  }
  return any ? std::optional(clock) : std::nullopt;
}

std::optional<UtcTime> time_from(std::string_view text) {
  const auto date = take_date(text);
  if (!date) return std::nullopt;
  Duration clock{};
  if (take(text, "T ")) {
    const auto taken = take_clock(text);
    if (!taken) return std::nullopt;
    clock = *taken;
  }
  if (text.empty() || text == "Z") return UtcTime{(*date + clock).count()};
  const bool west = text.front() == '-';
  if (!take(text, "+-")) return std::nullopt;
  const auto offset = take_clock(text);
  if (!offset || !text.empty()) return std::nullopt;
  const UtcTime time{(*date + clock + (west ? *offset : -*offset)).count()};
  return time.nanoseconds < 0 ? std::nullopt : std::optional(time);
}

std::string local_text(UtcTime time) {
  const std::time_t second = time.nanoseconds / 1'000'000'000;
  std::tm local{};
  if (::localtime_r(&second, &local) == nullptr) return utc_text(time);
  const auto minutes = local.tm_gmtoff / 60;
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}{}{:02}:{:02}", local.tm_year + 1900,
                     local.tm_mon + 1, local.tm_mday, local.tm_hour, local.tm_min, local.tm_sec,
                     time.nanoseconds / 1'000'000 % 1000, minutes < 0 ? '-' : '+',
                     std::abs(minutes) / 60, std::abs(minutes) % 60);
}

}  // namespace

std::string time_text(UtcTime time, Zone zone) {
  return zone == Zone::kUtc || time.nanoseconds <= 0 ? utc_text(time) : local_text(time);
}

tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now) {
  if (text == "now") return now;
  if (const auto time = time_from(text)) return *time;
  if (const auto ago = duration_from(text); ago && ago->count() <= now.nanoseconds)
    return UtcTime{now.nanoseconds - ago->count()};
  return tl::unexpected(
      fmt::format("'{}' is no time; write 2026-11-21, 2026-11-21T10:30 or 2026-11-21T10:30:05 "
                  "(UTC), the time with an offset such as +01:00, 2h for two hours ago, or now",
                  text));
}

}  // namespace fieldcast::cli
