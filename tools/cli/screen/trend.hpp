// The last values of channels that a person has looked at, and their picture in one line of text.
// Pure values.
#pragma once

#include <cstddef>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_path.hpp"

namespace fieldcast::cli {

struct TrendPoint {
  UtcTime at;
  double value = 0;
};
using TrendPoints = std::deque<TrendPoint>;

// A number, or 0 and 1 of a bool; texts have none.
[[nodiscard]] std::optional<double> trend_value(const Value& value);

class TrendBook {
 public:
  static constexpr std::size_t kMostChannels = 64;  // then the one that was looked at first goes
  static constexpr std::size_t kMostPoints = 512;   // of each channel: the newest

  // From now on values of this channel are kept.
  void follow(const ChannelPath& path);
  void add(const ChannelPath& path, const Value& value, UtcTime at);
  [[nodiscard]] const TrendPoints* find(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, TrendPoints> points_;
  std::list<ChannelPath> order_;  // of following
};

// The newest points, one in each column, between their least and their greatest value. With
// `unicode` in eighths of a line, else in ASCII. Empty: there is no point.
[[nodiscard]] std::string sparkline(const TrendPoints& points, std::size_t columns, bool unicode);

}  // namespace fieldcast::cli
