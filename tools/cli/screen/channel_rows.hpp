// Selects and sorts the channels on the screen of `fieldcast watch`. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/screen/row_list.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

enum class ChannelOrder : std::uint8_t { kBadFirst, kName, kValue, kAge, kRate, kCount };
[[nodiscard]] std::string_view order_text(ChannelOrder order);  // "bad first", "name", ...

struct ChannelChoice {
  ChannelOrder order = ChannelOrder::kBadFirst;
  bool inverted = false;
  bool grouped = true;    // by bus and device
  bool bad_only = false;  // hides GOOD channels
  std::string filter{};   // words: each must occur in path, unit or quality; case-insensitive
};

[[nodiscard]] Rank rank_of(const WatchModel::Row& row);

[[nodiscard]] std::vector<std::string> filter_words(std::string_view filter);
// Each word must occur; ignores the case of ASCII letters.
[[nodiscard]] bool has_words(std::string_view text, const std::vector<std::string>& words);

// Without members of folded groups. `item` of a channel points to its entry in model.rows().
struct ChannelRows {
  ListRows rows;
  std::size_t channels = 0, good = 0, bad = 0;  // of the model
  std::size_t matching = 0;                     // selected channels, folded or not
};
[[nodiscard]] ChannelRows channel_rows(const WatchModel& model, const ChannelChoice& choice,
                                       const RowList& list, Instant now);

using ChannelEntry = std::map<ChannelPath, WatchModel::Row>::value_type;
// REQUIRES: a channel row of channel_rows().
[[nodiscard]] inline const ChannelEntry& entry_of(const ListRow& row) {
  return *static_cast<const ChannelEntry*>(row.item);
}

struct TrendPoint {
  UtcTime at;
  double value = 0;
};
using TrendPoints = std::deque<TrendPoint>;

// A number, or 0 and 1 of a bool; empty for text.
[[nodiscard]] std::optional<double> trend_value(const Value& value);

// Recent values of selected channels, drawn as one line of text. Pure values.
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
