#include "core/bus/health/response_time.hpp"

#include <algorithm>

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

}  // namespace fieldcast
