// Recent values of selected channels, drawn as one line of text. Pure values.
#pragma once

#include <cstddef>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::cli {

struct TrendPoint {
  UtcTime at;
  double value = 0;
};
using TrendPoints = std::deque<TrendPoint>;

// A number, or 0 and 1 of a bool; empty for text.
[[nodiscard]] std::optional<double> trend_value(const Value& value);

class TrendHistory {
 public:
  // beyond this, the channel selected first is dropped
  static constexpr std::size_t kMostChannels = 64;
  static constexpr std::size_t kMostPoints = 512;  // of each channel: the newest

  void follow(const ChannelPath& path);
  void add(const ChannelPath& path, const Value& value, UtcTime at);
  [[nodiscard]] const TrendPoints* find(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, TrendPoints> points_;
  std::list<ChannelPath> order_;  // in the order of follow()
};

// One point in each column, scaled between minimum and maximum. With `unicode` in eighths of a
// line, else in ASCII.
[[nodiscard]] std::string sparkline(const TrendPoints& points, std::size_t columns, bool unicode);

}  // namespace fieldcast::cli
