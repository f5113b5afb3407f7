#include "core/bus/health/learning.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

namespace {
constexpr unsigned kMaxDoublings = 8;
}

void ResponseTime::measure(Duration measured) {
  if (in_window_ == kWindow) {
    longest_before_ = longest_;
    second_before_ = second_;
    longest_ = Duration::zero();
    soonest_ = second_ = Duration::max();
    in_window_ = 0;
    windows_ = 1;
  }
  ++in_window_;
  longest_ = std::max(longest_, measured);
  second_ = std::min(second_, std::max(soonest_, measured));
  soonest_ = std::min(soonest_, measured);
}

void ResponseTime::late(Duration measured) { longest_ = std::max(longest_, measured); }

void ResponseTime::learn(Duration measured) {
  measure(measured);
  measured = std::max(measured, Duration::zero());
  if (!known_) {
    mean_ = measured;
    spread_ = measured / 2;
    known_ = true;
  } else {
    const Duration error = measured - mean_;
    spread_ += (std::max(error, -error) - spread_) / 4;
    mean_ += error / 8;
  }
  doublings_ = 0;
}

void ResponseTime::timed_out() { doublings_ = std::min(doublings_ + 1, kMaxDoublings); }

void ResponseTime::forget() { *this = ResponseTime(configured_, allowance_); }

Duration ResponseTime::timeout() const {
  if (!known_) return configured_;
  // Twice the mean plus four deviations: a PLC responds once a scan, and a scan may have just
  // begun.
  const Duration learned = (mean_ * 2 + spread_ * 4 + allowance_) * (1 << doublings_);
  return std::min(std::max(learned, longest() + allowance_), configured_);
}

void PauseLearning::Share::count(bool responded) {
  ++tries;
  const double weight = 1.0 / std::min(tries, kMemory);
  failures += ((responded ? 0.0 : 1.0) - failures) * weight;
}

void PauseLearning::Share::add(const Share& other) {
  if (other.tries == 0) return;
  failures = (failures * tries + other.failures * other.tries) / (tries + other.tries);
  tries += other.tries;
}

void PauseLearning::tried(Duration rest, bool responded) {
  const auto step = static_cast<std::size_t>(
      std::upper_bound(kPauses.begin(), kPauses.end(), rest) - kPauses.begin());
  shares_[step].count(responded);
  lengthen();
  if (step_ > 0) shorten(step, responded);
}

void PauseLearning::lengthen() {
  Share longer;  // rests longer than the examined step
  for (std::size_t i = kPauses.size(); i > step_; --i) {
    longer.add(shares_[i]);
    const Share& share = shares_[i - 1];
    if (share.tries < kFewest || share.failures < kOften) continue;
    if (longer.tries < kFewest || longer.failures > kSeldom) return;
    step_ = i;
    shares_ = {};
    trial_.reset();
    responses_ = 0;
    return;
  }
}

void PauseLearning::shorten(std::size_t step, bool responded) {
  if (!trial_) {
    if (responded && ++responses_ >= next_trial_) begin_trial(1);
    return;
  }
  // Longer rests than the tested one do not count.
  if (whole_pauses_ == 0 && step <= trial_->step + 1 && step < step_) {
    ++trial_->tries;
    if (!responded) ++trial_->failures;
    if (trial_->failures >= 2 && 2 * trial_->failures > trial_->tries) return end_trial(false);
    if (trial_->tries >= kFewest) return end_trial(4 * trial_->failures <= trial_->tries);
  }
  if (!responded)
    whole_pauses_ = kAfterFailure;
  else if (whole_pauses_ > 0)
    --whole_pauses_;
}

void PauseLearning::begin_trial(std::size_t less) {
  trial_ = Trial{.step = step_ - std::min(less, step_), .less = less};
  whole_pauses_ = 0;
  responses_ = 0;
}

// If a greater step fails, smaller steps are tried.
void PauseLearning::end_trial(bool held) {
  const Trial ended = *std::exchange(trial_, std::nullopt);
  if (held) {
    step_ = ended.step;
    shares_ = {};
    if (step_ > 0) return begin_trial(2 * ended.less);
    next_trial_ = kFirstTrial;
  } else if (ended.less > 1) {
    begin_trial(1);
    whole_pauses_ = kAfterFailure;
  } else {
    next_trial_ = std::min(2 * next_trial_, kRarestTrial);
  }
}

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
