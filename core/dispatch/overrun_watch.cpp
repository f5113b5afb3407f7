#include "core/dispatch/overrun_watch.hpp"

#include <algorithm>

namespace fieldcast {

void OverrunWatch::wire_free(Instant now, bool rests) {
  if (rests_since_ < now) rested_ += now - rests_since_;
  rests_since_ = rests ? now : kNever;
}

void OverrunWatch::acquired(bool late, Instant now) {
  constexpr std::uint32_t kWindow = 256;
  constexpr double kRests = 0.02, kMore = 1.05, kLess = 0.99;
  if (now < settled_at_) return;
  if (watched_ == 0) window_began_ = now, rested_ = Duration::zero();
  late_ += late ? 1 : 0;
  if (++watched_ < kWindow) return;
  const bool rests = ns(rested_) > kRests * ns(now - window_began_);
  if (late_ > kWindow / 20 && !rests) overrun_ = std::min(kMost, overrun_ * kMore);
  if (late_ == 0 || rests) overrun_ = std::max(1.0, overrun_ * kLess);
  late_ = watched_ = 0;
}

}  // namespace fieldcast
