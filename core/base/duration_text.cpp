#include "core/base/duration_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace fieldcast {
namespace {

constexpr Duration kLongestDuration = std::chrono::hours{24 * 365 * 200};  // above every limit

struct Unit {
  std::string_view name;
  double nanoseconds;
};
constexpr std::array<Unit, 7> kUnits{{{"us", 1e3},
                                      {"ms", 1e6},
                                      {"s", 1e9},
                                      {"m", 60e9},
                                      {"min", 60e9},
                                      {"h", 3600e9},
                                      {"d", 86'400e9}}};

constexpr std::array<std::pair<std::string_view, std::string_view>, 24> kOtherUnits{
    {{"us", "us"},      {"µs", "us"},       {"usec", "us"},  {"microseconds", "us"},
     {"ms", "ms"},      {"msec", "ms"},     {"msecs", "ms"}, {"milliseconds", "ms"},
     {"s", "s"},        {"sec", "s"},       {"secs", "s"},   {"second", "s"},
     {"seconds", "s"},  {"m", "min"},       {"min", "min"},  {"mins", "min"},
     {"minute", "min"}, {"minutes", "min"}, {"h", "h"},      {"hour", "h"},
     {"hours", "h"},    {"d", "d"},         {"day", "d"},    {"days", "d"}}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool plain_decimal(std::string_view text) {
  if (text.empty() || !is_digit(text.front()) || !is_digit(text.back())) return false;
  bool point = false;
  for (const char c : text) {
    if (c == '.' ? std::exchange(point, true) : !is_digit(c)) return false;
  }
  return true;
}

bool within(const std::string& text, const DurationBounds& bounds) {
  const auto value = duration_from(text);
  return value && *value >= bounds.min && *value <= bounds.max;
}

// Tries ms for large numbers, s for others, then the units that fit the bounds.
std::string with_a_unit(const std::string& number, const DurationBounds& bounds) {
  const bool large = number.find('.') == std::string::npos && number.size() >= 2;
  const std::string_view first = large ? "ms" : "s";
  for (const std::string_view unit : {first, std::string_view("s"), std::string_view("ms"),
                                      std::string_view("min"), std::string_view("h")}) {
    if (auto text = number + std::string(unit); within(text, bounds)) return text;
  }
  return {};
}

// "500" -> "500ms", "5 sec" -> "5s", "1,5s" -> "1.5s", ".5s" -> "0.5s".
std::string likely_duration(std::string_view text, const DurationBounds& bounds) {
  std::string number;
  std::size_t length = 0;
  for (; length < text.size() &&
         (is_digit(text[length]) || text[length] == '.' || text[length] == ',');
       ++length)
    number += text[length] == ',' ? '.' : text[length];
  if (number.starts_with('.')) number.insert(0, 1, '0');
  if (!plain_decimal(number)) return {};
  std::string unit;
  for (const char c : text.substr(length)) {
    if (c != ' ' || !unit.empty())
      unit += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (unit.empty()) return with_a_unit(number, bounds);
  for (const auto& [spelling, meant] : kOtherUnits) {
    if (unit != spelling) continue;
    number += meant;
    return within(number, bounds) ? number : std::string{};
  }
  return {};
}

}  // namespace

std::optional<Duration> duration_from(std::string_view text) {
  for (const auto& [unit, nanoseconds] : kUnits) {
    if (!text.ends_with(unit)) continue;
    const auto number = text.substr(0, text.size() - unit.size());
    if (!plain_decimal(number)) continue;
    double value = 0;
    const auto error = std::from_chars(number.data(), number.data() + number.size(), value).ec;
    if (error != std::errc{} ||
        value * nanoseconds >= static_cast<double>(kLongestDuration.count()))
      return kLongestDuration;
    return Duration{std::llround(value * nanoseconds)};
  }
  return std::nullopt;
}

std::string fault_text(std::string_view text, const DurationFault& fault) {
  return "'" + std::string(text) + "' " + fault.what + "; allowed: " + fault.allowed +
         (fault.suggestion.empty() ? "" : "; did you mean " + fault.suggestion + "?");
}

tl::expected<Duration, DurationFault> read_duration(std::string_view text,
                                                    const DurationBounds& bounds) {
  const bool bare = plain_decimal(text);
  const auto value = duration_from(bare && bounds.bare_seconds ? std::string(text) + 's' : text);
  const std::string span = to_text(bounds.min) + " to " + to_text(bounds.max);
  if (value && *value >= bounds.min && *value <= bounds.max) return *value;
  if (value)
    return tl::unexpected(
        DurationFault{*value < bounds.min ? "is too short" : "is too long", span, {}});
  const bool negative =
      text.starts_with('-') && (duration_from(text.substr(1)) || plain_decimal(text.substr(1)));
  return tl::unexpected(DurationFault{bare       ? "has no unit"
                                      : negative ? "is negative"
                                                 : "is no duration",
                                      std::string(kDurationForm) + ", " + span,
                                      likely_duration(text, bounds)});
}

}  // namespace fieldcast
