// How much more of the wire reads need than planned: retries and late answers show in points that
// come late although the wire never rests. Plain value; fed by the plan runner.
#pragma once

#include <cstdint>

#include "core/plan/time_math.hpp"

namespace fieldcast {

class OverrunWatch {
 public:
  // The wire was free at `now`; it rests from then on, or it does not.
  void wire_free(Instant now, bool rests);
  // A point was acquired that had a deadline.
  void acquired(bool late, Instant now);
  // A plan went into force. What is late before `settled` says nothing of it.
  void plan_began(Instant settled) { settled_at_ = settled; }

  // 1: the wire is as planned; at most kMost.
  [[nodiscard]] double overrun() const { return overrun_; }

 private:
  static constexpr double kMost = 16;
  double overrun_ = 1;
  Instant settled_at_{};
  // Of the present window of acquisitions.
  std::uint32_t late_ = 0, watched_ = 0;
  Instant window_began_{};
  Duration rested_{};
  Instant rests_since_ = kNever;
};

}  // namespace fieldcast
