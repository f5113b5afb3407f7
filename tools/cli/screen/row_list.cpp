#include "tools/cli/screen/row_list.hpp"

#include <algorithm>

namespace fieldcast::cli {

void RowList::assign(ListRows rows) {
  rows_ = std::move(rows);
  if (rows_.empty()) {
    index_ = 0;
    return;
  }
  if (moved_) {
    const auto found = std::ranges::find(rows_, selected_, &ListRow::id);
    if (found != rows_.end()) index_ = static_cast<std::size_t>(found - rows_.begin());
  }
  index_ = moved_ ? std::min(index_, rows_.size() - 1) : 0;
  selected_ = rows_[index_].id;
}

const ListRow* RowList::selected() const { return rows_.empty() ? nullptr : &rows_[index_]; }

void RowList::select(std::size_t index) {
  if (rows_.empty()) return;
  index_ = std::min(index, rows_.size() - 1);
  moved_ = index_ != 0;
  selected_ = rows_[index_].id;
}

void RowList::move(std::ptrdiff_t by) {
  const auto to = static_cast<std::ptrdiff_t>(index_) + by;
  select(static_cast<std::size_t>(std::max<std::ptrdiff_t>(to, 0)));
}

std::size_t RowList::top(std::size_t lines) {
  if (lines == 0) return top_;
  if (index_ < top_) top_ = index_;
  if (index_ >= top_ + lines) top_ = index_ - lines + 1;
  top_ = std::min(top_, rows_.size() > lines ? rows_.size() - lines : 0);
  return top_;
}

void RowList::scroll(std::ptrdiff_t by, std::size_t lines) {
  const std::size_t last = rows_.size() > lines ? rows_.size() - lines : 0;
  const auto to = static_cast<std::ptrdiff_t>(top_) + by;
  top_ = std::min(last, static_cast<std::size_t>(std::max<std::ptrdiff_t>(to, 0)));
  if (rows_.empty() || lines == 0) return;
  if (const auto in_sight = std::clamp(index_, top_, top_ + lines - 1); in_sight != index_)
    select(in_sight);
}

void RowList::fold(const ChannelPath& id, bool folded) {
  if (folded)
    folded_.insert(id);
  else
    folded_.erase(id);
}

}  // namespace fieldcast::cli
