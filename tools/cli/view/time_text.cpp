#include "tools/cli/view/time_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "core/base/duration_text.hpp"

namespace fieldcast::cli {
namespace {

// Takes `digits` digits from the front of text.
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
  // What fits 64 bits of nanoseconds.
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
  if (!text.empty() && text != "Z") return std::nullopt;
  return UtcTime{(*date + clock).count()};
}

}  // namespace

tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now) {
  if (text == "now") return now;
  if (const auto time = time_from(text)) return *time;
  if (const auto ago = duration_from(text); ago && ago->count() <= now.nanoseconds)
    return UtcTime{now.nanoseconds - ago->count()};
  return tl::unexpected(
      fmt::format("'{}' is no time; write 2026-11-21, 2026-11-21T10:30 or 2026-11-21T10:30:05 "
                  "(UTC), 2h for two hours ago, or now",
                  text));
}

}  // namespace fieldcast::cli
