#include "core/bus/answer_time.hpp"

#include <algorithm>

namespace fieldcast {
namespace {
constexpr unsigned kMaxDoublings = 8;
}

void AnswerTime::learn(Duration measured) {
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

void AnswerTime::timed_out() { doublings_ = std::min(doublings_ + 1, kMaxDoublings); }

void AnswerTime::forget() {
  known_ = false;
  mean_ = spread_ = Duration::zero();
  doublings_ = 0;
}

Duration AnswerTime::timeout() const {
  if (!known_) return configured_;
  // Twice the mean beside four spreads: PLCs answer once a scan, and a scan may have just begun.
  const Duration learned = (mean_ * 2 + spread_ * 4 + allowance_) * (1 << doublings_);
  return std::min(learned, configured_);
}

}  // namespace fieldcast
