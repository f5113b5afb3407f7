#include "tools/progress/progress_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/text/cell_text.hpp"

namespace fieldcast {
namespace {

constexpr double kFirstGuess = 0.1;         // seconds
constexpr double kLongest = 100 * 86400.0;  // longer estimates are not shown
constexpr std::size_t kLeastOfWhat = 4;     // columns

}  // namespace

ProgressText progress_text(std::string_view what, double share, Duration elapsed) {
  share = std::clamp(share, 0.0, 1.0);
  ProgressText text{std::string(what), fmt::format("{:.0f} %", share * 100)};
  const double seconds = to_seconds(elapsed);
  if (share <= 0 || seconds < kFirstGuess) return text;
  const double left = seconds / share * (1 - share);
  if (left > kLongest) return text;
  const std::chrono::seconds rounded{static_cast<std::int64_t>(left + 0.5)};
  text.how_far += fmt::format(", {} left", to_text(Duration{rounded}));
  return text;
}

ProgressText progress_count_text(std::string_view what, std::uint64_t count, std::string_view unit,
                                 Duration elapsed) {
  ProgressText text{std::string(what), fmt::format("{} {}", count, unit)};
  const double seconds = to_seconds(elapsed);
  if (seconds < kFirstGuess) return text;
  text.how_far += fmt::format(", {:.0f} each second", static_cast<double>(count) / seconds);
  return text;
}

std::string progress_line_text(const ProgressText& text, std::size_t columns) {
  constexpr std::string_view kBetween = ": ";
  const std::string what = cli::shown(text.what), how_far = cli::shown(text.how_far);
  const std::size_t taken = cli::columns_of(how_far) + kBetween.size();
  if (taken + cli::columns_of(what) <= columns) return what + std::string(kBetween) + how_far;
  if (taken + kLeastOfWhat > columns) return cli::cut(how_far, columns);
  return cli::fitted(what, columns - taken) + std::string(kBetween) + how_far;
}

}  // namespace fieldcast
