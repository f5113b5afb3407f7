#include "tools/cli/model/sample_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <variant>

#include "core/base/duration_text.hpp"
#include "core/base/value.hpp"
#include "tools/cli/model/address_notation.hpp"

namespace fieldcast::cli {

namespace {

std::string short_text(double number, const char* unit) {
  return number < 10 ? fmt::format("{:.2f} {}", number, unit)
                     : fmt::format("{:.0f} {}", number, unit);
}

// "2026-11-21T03:04:05.678"
std::string stamp_text(const std::tm& time, std::int64_t milliseconds) {
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}", time.tm_year + 1900,
                     time.tm_mon + 1, time.tm_mday, time.tm_hour, time.tm_min, time.tm_sec,
                     milliseconds);
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

std::string rate_text(double rate) {
  return rate < 10 ? fmt::format("{:.1f}/s", rate) : fmt::format("{:.0f}/s", rate);
}

Tone age_tone(const StationSample& sample, const StationChannel* about, UtcTime now) {
  if (about == nullptr || about->refresh == Duration{} || sample.acquired_at.nanoseconds == 0)
    return Tone::kFaint;
  return now.nanoseconds - sample.acquired_at.nanoseconds > 2 * about->refresh.count()
             ? Tone::kWarning
             : Tone::kPlain;
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
  if (sample.quality == Quality::kBadRange && sample.device_code == kNoResultCode)
    return fmt::format("{} (no finite result)", text);
  return fmt::format("{} ({})", text,
                     device_code_at(about != nullptr ? about->at : "", sample.device_code));
}

std::string age_text(UtcTime then, UtcTime now) {
  if (then.nanoseconds == 0) return "-";
  const double seconds =
      std::max(0.0, static_cast<double>(now.nanoseconds - then.nanoseconds) / 1e9);
  if (seconds < 60) return short_text(seconds, "s");
  if (seconds < 3600) return short_text(seconds / 60, "min");
  return short_text(seconds / 3600, "h");
}

std::string utc_text(UtcTime time) {
  if (time.nanoseconds == 0) return "-";
  const std::chrono::milliseconds all{time.nanoseconds / 1'000'000};
  const auto seconds = std::chrono::floor<std::chrono::seconds>(all);
  const std::time_t second = seconds.count();
  std::tm utc{};
  ::gmtime_r(&second, &utc);
  return stamp_text(utc, (all - seconds).count()) + 'Z';
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

std::string gone_line(const ChannelPath& path, UtcTime now) {
  return printable(
      fmt::format("{}  {}/{}/{}  -  GONE", utc_text(now), path.bus, path.device, path.channel));
}

Json gone_json(const ChannelPath& path) {
  return {{"event", "no_bridge"},
          {"bus", path.bus},
          {"device", path.device},
          {"channel", path.channel}};
}

namespace {

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == any_of.npos) return false;
  text.remove_prefix(1);
  return true;
}

// Takes a text of this form, in which 0 is any digit: "0000-00-00". Returns its numbers.
std::optional<std::array<int, 3>> take_form(std::string_view& text, std::string_view form) {
  if (text.size() < form.size()) return std::nullopt;
  std::array<int, 3> numbers{};
  std::size_t number = 0;
  for (std::size_t i = 0; i < form.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (form[i] == '0' ? !digit : text[i] != form[i]) return std::nullopt;
    if (digit)
      numbers[number] = 10 * numbers[number] + (text[i] - '0');
    else
      ++number;
  }
  text.remove_prefix(form.size());
  return numbers;
}

std::optional<Duration> take_date(std::string_view& text) {
  namespace chrono = std::chrono;
  const auto date = take_form(text, "0000-00-00");
  if (!date) return std::nullopt;
  const auto [year, month, day] = *date;
  const chrono::year_month_day at{chrono::year{year}, chrono::month{static_cast<unsigned>(month)},
                                  chrono::day{static_cast<unsigned>(day)}};
  // limits of 64-bit nanoseconds
  if (!at.ok() || year < 1970 || year > 2261) return std::nullopt;
  return Duration{chrono::sys_days{at}.time_since_epoch()};
}

// "10:30", "10:30:05", "10:30:05.25"
std::optional<Duration> take_clock(std::string_view& text) {
  const bool with_seconds = text.size() > 5 && text[5] == ':';
  const auto clock = take_form(text, with_seconds ? "00:00:00" : "00:00");
  if (!clock) return std::nullopt;
  const auto [hour, minute, second] = *clock;
  if (hour > 23 || minute > 59 || second > 59) return std::nullopt;
  Duration time =
      std::chrono::hours{hour} + std::chrono::minutes{minute} + std::chrono::seconds{second};
  if (!with_seconds || !take(text, ".")) return time;
  if (text.empty() || text.front() < '0' || text.front() > '9') return std::nullopt;
  std::int64_t worth = 100'000'000;
  for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; worth /= 10) {
    time += Duration{worth * (text.front() - '0')};
    text.remove_prefix(1);
  }
  return time;
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
  return fmt::format("{}{}{:02}:{:02}", stamp_text(local, time.nanoseconds / 1'000'000 % 1000),
                     minutes < 0 ? '-' : '+', std::abs(minutes) / 60, std::abs(minutes) % 60);
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
