#include "core/bus/health/block_learning.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

bool holds(const Range& whole, const Range& part) {
  return whole.first <= part.first && part.end() <= whole.end();
}
bool touches(const Range& a, const Range& b) { return a.first < b.end() && b.first < a.end(); }

}  // namespace

void BlockLearning::refused(const Range& block, std::vector<Range> wanted) {
  for (const Search& search : open_) {
    if (holds(search.block, block)) return;  // part of an open search
  }
  if (open_.size() == kMostOpen) open_.erase(open_.begin());
  open_.push_back({block, std::move(wanted), std::vector<bool>(block.count)});
}

void BlockLearning::bad(const Range& point) {
  std::erase_if(open_, [&](const Search& search) { return holds(search.block, point); });
}

bool BlockLearning::read(const Range& block, Instant now) {
  largest_ = std::max(largest_, block.count);
  std::erase_if(gaps_, [&](const Range& gap) { return touches(gap, block); });
  bool changed = false;
  std::erase_if(open_, [&](Search& search) {
    if (!touches(search.block, block)) return false;
    if (holds(block, search.block)) return true;  // the device accepts the block after all
    const std::uint32_t from = std::max(block.first, search.block.first),
                        to = std::min(block.end(), search.block.end());
    std::fill(search.seen.begin() + (from - search.block.first),
              search.seen.begin() + (to - search.block.first), true);
    std::erase_if(search.wanted, [&](const Range& point) { return holds(block, point); });
    if (!search.wanted.empty()) return false;
    changed = conclude(search, now) || changed;
    return true;
  });
  return changed;
}

// Ends a search whose points were all read. Returns true if the longest block changed.
bool BlockLearning::conclude(const Search& search, Instant now) {
  bool whole = true;
  for (std::uint32_t i = 0; i < search.block.count; ++i) {
    if (search.seen[i]) continue;
    whole = false;
    Range gap{search.block.area, search.block.first + i, 0};
    for (; i < search.block.count && !search.seen[i]; ++i) ++gap.count;
    note_gap(gap);
  }
  if (!whole) return false;
  // A longer block may have been accepted elsewhere before the device rejected this one.
  if (largest_ >= search.block.count) largest_ = search.block.count - 1;
  const std::uint32_t before = longest_;
  longest_ = largest_;
  learned_ = now;
  return longest_ != before;
}

void BlockLearning::note_gap(const Range& gap) {
  if (std::find(gaps_.begin(), gaps_.end(), gap) != gaps_.end()) return;
  if (gaps_.size() == kMostGaps) gaps_.erase(gaps_.begin());
  gaps_.push_back(gap);
}

bool BlockLearning::expire(Instant now) {
  if (longest_ == 0 || now - learned_ < kRemember) return false;
  return forget();
}

bool BlockLearning::forget() {
  const bool known = longest_ != 0;
  open_.clear();
  gaps_.clear();
  largest_ = longest_ = 0;
  return known;
}

}  // namespace fieldcast
