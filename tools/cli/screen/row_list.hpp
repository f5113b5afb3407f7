// A list of buses, devices and channels that folds and scrolls, with one selected row. Pure values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "core/model/channel_pattern.hpp"

namespace fieldcast::cli {

enum class Rank : std::uint8_t { kBad, kUncertain, kUnread, kGood };

// One row. A bus has an empty device, a device an empty channel.
struct ListRow {
  ChannelPath id;
  Rank rank = Rank::kGood;  // of a group: of its worst member
  // Of a group: counts of its members, folded or not.
  std::uint32_t members = 0, good = 0, bad = 0;
  bool folded = false;
  const void* item = nullptr;  // set by the owner; in a channel list the channel's samples
  [[nodiscard]] bool is_bus() const { return id.device.empty(); }
  [[nodiscard]] bool is_device() const { return !is_bus() && id.channel.empty(); }
  [[nodiscard]] bool is_channel() const { return !id.channel.empty(); }
  [[nodiscard]] bool is_group() const { return members != 0; }
};
using ListRows = std::vector<ListRow>;

class RowList {
 public:
  // The selected row stays selected, or the one at its position. Before the first movement, the
  // first row stays selected.
  void assign(ListRows rows);
  [[nodiscard]] const ListRows& rows() const { return rows_; }

  [[nodiscard]] const ListRow* selected() const;  // null: the list is empty
  [[nodiscard]] std::size_t index() const { return index_; }
  void select(std::size_t index);  // selects the last row if there are fewer
  void move(std::ptrdiff_t by);    // stops at the ends
  // First visible row for this number of lines; follows the selection.
  std::size_t top(std::size_t lines);
  // Scrolls as a mouse wheel does; moves the selection only to keep it visible.
  void scroll(std::ptrdiff_t by, std::size_t lines);

  // Folding becomes effective with the next assign().
  [[nodiscard]] bool is_folded(const ChannelPath& id) const { return folded_.contains(id); }
  void fold(const ChannelPath& id, bool folded);

 private:
  ListRows rows_;
  ChannelPath selected_;
  bool moved_ = false;  // by the user
  std::size_t index_ = 0, top_ = 0;
  std::set<ChannelPath> folded_;
};

}  // namespace fieldcast::cli
