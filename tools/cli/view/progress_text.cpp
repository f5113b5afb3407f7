#include "tools/cli/view/progress_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::cli {
namespace {

constexpr double kFirstGuess = 0.1;         // seconds
constexpr double kLongest = 100 * 86400.0;  // a guess beyond it is none

}  // namespace

std::string progress_text(std::string_view what, double share, Duration elapsed) {
  share = std::clamp(share, 0.0, 1.0);
  std::string text = fmt::format("{}: {:.0f} %", what, share * 100);
  const double seconds = to_seconds(elapsed);
  if (share <= 0 || seconds < kFirstGuess) return text;
  const double left = seconds / share * (1 - share);
  if (left > kLongest) return text;
  const std::chrono::seconds rounded{static_cast<std::int64_t>(left + 0.5)};
  return fmt::format("{}, {} left", text, to_text(Duration{rounded}));
}

std::string progress_count_text(std::string_view what, std::uint64_t count, std::string_view unit,
                                Duration elapsed) {
  std::string text = fmt::format("{}: {} {}", what, count, unit);
  const double seconds = to_seconds(elapsed);
  if (seconds < kFirstGuess) return text;
  return fmt::format("{}, {:.0f} each second", text, static_cast<double>(count) / seconds);
}

}  // namespace fieldcast::cli
