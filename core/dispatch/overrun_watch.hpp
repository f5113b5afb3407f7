// Estimates how much more wire time reads need than planned, from points that are late although the
// wire never rests. Plain value.
#pragma once

#include <cstdint>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

class OverrunWatch {
 public:
  // `rests`: from `now` on.
  void wire_free(Instant now, bool rests);
  void acquired(bool late, Instant now);
  // A plan took effect. Late points before `settled` do not count.
  void plan_began(Instant settled) { settled_at_ = settled; }

  // 1: as planned; at most kMost.
  [[nodiscard]] double overrun() const { return overrun_; }

 private:
  static constexpr double kMost = 16;
  double overrun_ = 1;
  Instant settled_at_{};
  // Counters of the present window of acquisitions.
  std::uint32_t late_ = 0, watched_ = 0;
  Instant window_began_{};
  Duration rested_{};
  Instant rests_since_ = kNever;
};

}  // namespace fieldcast
