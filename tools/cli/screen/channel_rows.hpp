// Selects and sorts the channels on the screen of `fieldcast watch`. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/screen/row_list.hpp"
#include "tools/cli/text/frame.hpp"

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

}  // namespace fieldcast::cli
