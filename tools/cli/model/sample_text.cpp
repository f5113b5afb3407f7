#include "tools/cli/model/sample_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <variant>

#include "core/base/duration_text.hpp"
#include "core/base/value.hpp"
#include "tools/cli/model/address_notation.hpp"

namespace fieldcast::cli {

namespace {

std::string tenths(double number, const char* unit) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), number < 10 ? "%.2f %s" : "%.0f %s", number, unit);
  return buffer.data();
}

}  // namespace

Json sample_json(const StationSample& sample) {
  Json json{{"bus", sample.bus},
            {"device", sample.device},
            {"channel", sample.channel},
            {"value", sample.acquired_at.nanoseconds == 0 ? Json() : Json(sample.value)},
            {"quality", to_text(sample.quality)},
            {"acquired_at", sample.acquired_at.nanoseconds},
            {"sequence", sample.sequence}};
  if (sample.device_code != 0) json.add("device_code", sample.device_code);
  return json;
}

std::string value_text(const Value& value, std::string_view type) {
  const auto* number = std::get_if<double>(&value);
  if (number == nullptr) return to_text(value);
  return type == "float32" ? float32_text(*number) : number_text(*number);
}

Tone tone_of(Quality quality) {
  switch (quality) {
    case Quality::kGood: return Tone::kGood;
    case Quality::kUncertain:
    case Quality::kNotYetRead: return Tone::kWarning;
    default: return Tone::kBad;
  }
}

std::string quality_text(const StationSample& sample, const StationChannel* about) {
  const std::string text{to_text(sample.quality)};
  if (sample.device_code == 0) return text;
  if (sample.quality == Quality::kBadRange && sample.device_code == kNotAvailableCode)
    return fmt::format("{} ({})", text, to_text(Cause::kNotAvailable));
  return fmt::format("{} ({})", text,
                     device_code_at(about != nullptr ? about->at : "", sample.device_code));
}

std::string age_text(UtcTime then, UtcTime now) {
  if (then.nanoseconds == 0) return "-";
  const double seconds =
      std::max(0.0, static_cast<double>(now.nanoseconds - then.nanoseconds) / 1e9);
  if (seconds < 60) return tenths(seconds, "s");
  if (seconds < 3600) return tenths(seconds / 60, "min");
  return tenths(seconds / 3600, "h");
}

std::string utc_text(UtcTime time) {
  if (time.nanoseconds == 0) return "-";
  namespace chrono = std::chrono;
  const chrono::sys_time<chrono::milliseconds> at{
      chrono::milliseconds{time.nanoseconds / 1'000'000}};
  const auto day = chrono::floor<chrono::days>(at);
  const chrono::year_month_day date{day};
  const chrono::hh_mm_ss clock{at - day};
  std::array<char, 40> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()),
                static_cast<int>(clock.subseconds().count()));
  return buffer.data();
}

std::string clock_text(UtcTime time) {
  const std::string text = utc_text(time);
  return text == "-" ? text : text.substr(11, 8) + 'Z';
}

std::string sample_line(const StationSample& sample, const StationChannel* about) {
  std::string line = fmt::format("{}  {}/{}/{}  ", utc_text(sample.acquired_at), sample.bus,
                                 sample.device, sample.channel);
  line += sample.acquired_at.nanoseconds == 0
              ? "-"
              : value_text(sample.value, about != nullptr ? about->type : std::string{});
  if (about != nullptr && !about->unit.empty()) line += ' ' + about->unit;
  return printable(fmt::format("{}  {}", line, quality_text(sample, about)));
}

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
