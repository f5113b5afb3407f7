// Which channels the screen of `fieldcast watch` lists, and in which order. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/screen/frame.hpp"
#include "tools/cli/screen/row_list.hpp"

namespace fieldcast::cli {

enum class ChannelOrder : std::uint8_t { kBadFirst, kName, kValue, kAge, kRate, kCount };
[[nodiscard]] std::string_view order_text(ChannelOrder order);  // "bad first", "name", ...

struct ChannelChoice {
  ChannelOrder order = ChannelOrder::kBadFirst;
  bool inverted = false;
  bool grouped = true;    // by bus and device
  bool bad_only = false;  // without what is GOOD
  std::string filter{};   // words: each is somewhere in path, unit or quality; case does not matter
};

[[nodiscard]] Rank rank_of(const WatchModel::Row& row);

// The words of a filter, each in lower case.
[[nodiscard]] std::vector<std::string> filter_words(std::string_view filter);
// True when each word is somewhere in the text, whatever the case of ASCII letters is.
[[nodiscard]] bool has_words(std::string_view text, const std::vector<std::string>& words);

// The rows in their order, without those in groups that `list` has folded. `item` of a channel is
// its entry in model.rows(), whose address does not change.
struct ChannelRows {
  ListRows rows;
  std::size_t channels = 0, good = 0, bad = 0;  // of the model
  std::size_t matching = 0;                     // of them that are chosen, folded or not
};
[[nodiscard]] ChannelRows channel_rows(const WatchModel& model, const ChannelChoice& choice,
                                       const RowList& list, Instant now);

using ChannelEntry = std::map<ChannelPath, WatchModel::Row>::value_type;
// REQUIRES: a row of a channel, made by channel_rows().
[[nodiscard]] inline const ChannelEntry& entry_of(const ListRow& row) {
  return *static_cast<const ChannelEntry*>(row.item);
}

}  // namespace fieldcast::cli
