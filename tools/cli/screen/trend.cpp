#include "tools/cli/screen/trend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <variant>

namespace fieldcast::cli {
namespace {

constexpr std::array<std::string_view, 8> kEighths{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr std::array<std::string_view, 8> kAscii{"_", ".", ",", "-", "=", "+", "*", "#"};

}  // namespace

std::optional<double> trend_value(const Value& value) {
  return std::visit(
      [](const auto& one) -> std::optional<double> {
        using T = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return std::nullopt;
        } else {
          const auto number = static_cast<double>(one);
          return std::isfinite(number) ? std::optional(number) : std::nullopt;
        }
      },
      value);
}

void TrendHistory::follow(const ChannelPath& path) {
  if (!points_.try_emplace(path).second) return;
  order_.push_back(path);
  if (order_.size() <= kMostChannels) return;
  points_.erase(order_.front());
  order_.pop_front();
}

void TrendHistory::add(const ChannelPath& path, const Value& value, UtcTime at) {
  const auto found = points_.find(path);
  if (found == points_.end()) return;
  const auto number = trend_value(value);
  if (!number) return;
  TrendPoints& points = found->second;
  if (!points.empty() && points.back().at.nanoseconds == at.nanoseconds) return;
  points.push_back({at, *number});
  if (points.size() > kMostPoints) points.pop_front();
}

const TrendPoints* TrendHistory::find(const ChannelPath& path) const {
  const auto found = points_.find(path);
  return found == points_.end() ? nullptr : &found->second;
}

std::string sparkline(const TrendPoints& points, std::size_t columns, bool unicode) {
  const std::size_t count = std::min(points.size(), columns);
  if (count == 0) return {};
  const auto first = points.end() - static_cast<std::ptrdiff_t>(count);
  const auto [least, most] = std::minmax_element(
      first, points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  const double low = least->value, span = most->value - low;
  std::string line;
  for (auto point = first; point != points.end(); ++point) {
    const double share = span > 0 && std::isfinite(span) ? (point->value - low) / span : 0;
    const auto step = std::min<std::size_t>(7, static_cast<std::size_t>(share * 8));
    line += (unicode ? kEighths : kAscii)[step];
  }
  return line;
}

}  // namespace fieldcast::cli
