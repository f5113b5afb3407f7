#include "core/bus/health/pause_learning.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

void PauseLearning::Share::count(bool answered) {
  ++tries;
  const double weight = 1.0 / std::min(tries, kMemory);
  failures += ((answered ? 0.0 : 1.0) - failures) * weight;
}

void PauseLearning::Share::add(const Share& other) {
  if (other.tries == 0) return;
  failures = (failures * tries + other.failures * other.tries) / (tries + other.tries);
  tries += other.tries;
}

void PauseLearning::tried(Duration rest, bool answered) {
  const auto step = static_cast<std::size_t>(
      std::upper_bound(kPauses.begin(), kPauses.end(), rest) - kPauses.begin());
  shares_[step].count(answered);
  lengthen();
  if (step_ > 0) shorten(step, answered);
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
    answers_ = 0;
    return;
  }
}

void PauseLearning::shorten(std::size_t step, bool answered) {
  if (!trial_) {
    if (answered && ++answers_ >= next_trial_) begin_trial(1);
    return;
  }
  // Longer rests than the tested one do not count.
  if (whole_pauses_ == 0 && step <= trial_->step + 1 && step < step_) {
    ++trial_->tries;
    if (!answered) ++trial_->failures;
    if (trial_->failures >= 2 && 2 * trial_->failures > trial_->tries) return end_trial(false);
    if (trial_->tries >= kFewest) return end_trial(4 * trial_->failures <= trial_->tries);
  }
  if (!answered)
    whole_pauses_ = kAfterFailure;
  else if (whole_pauses_ > 0)
    --whole_pauses_;
}

void PauseLearning::begin_trial(std::size_t less) {
  trial_ = Trial{.step = step_ - std::min(less, step_), .less = less};
  whole_pauses_ = 0;
  answers_ = 0;
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

}  // namespace fieldcast
