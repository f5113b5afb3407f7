#include "tools/cli/model/sample_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <variant>

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

}  // namespace fieldcast::cli
