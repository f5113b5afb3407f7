#include "tools/cli/duration_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace fieldcast::cli {

tl::expected<Duration, std::string> parse_duration(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, double>, 7> kUnits{
      {{"", 1}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1}, {"min", 60}, {"h", 3600}, {"d", 86400}}};
  constexpr double kYear = 365.0 * 86400;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  if (error == std::errc{}) {
    const auto unit = text.substr(static_cast<std::size_t>(end - text.data()));
    for (const auto& [name, seconds] : kUnits) {
      if (unit != name || !std::isfinite(number)) continue;
      const double total = number * seconds;
      if (total >= 1e-6 && total < kYear) return from_seconds(total);
    }
  }
  return tl::unexpected("'" + std::string(text) + "' is no duration; write 500ms, 2s, 1.5min, 1h, or seconds without a unit");
}

}  // namespace fieldcast::cli
