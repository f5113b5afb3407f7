// How much sooner than planned the reads of a device end. A line behind a converter, or a
// pseudo-terminal, carries characters faster than its rate says. A read that begins in time for the
// rate would end long before it is due, and be made again. Plain value.
#pragma once

#include <algorithm>

#include "core/plan/time_math.hpp"

namespace fieldcast {

class LinePace {
 public:
  // A read that was planned to take `planned` until its answer ended took `took`.
  void read(Duration took, Duration planned) {
    if (planned <= Duration::zero()) return;
    const double share = ns(took) / ns(planned);
    slowest_ = std::max(slowest_, std::min(share, 1.0));
    if (++reads_ < kWindow) return;
    before_ = slowest_;
    slowest_ = 0;
    reads_ = 0;
  }
  // Of the planned time, at most 1: the slowest of the last reads. Small differences do not
  // count.
  [[nodiscard]] double share() const {
    const double share = std::max(before_, slowest_);
    return share < kNotable ? share : 1.0;
  }
  [[nodiscard]] Duration of(Duration planned) const {
    const double paced = share();
    return paced < 1 ? part_of(paced, planned) : planned;
  }

 private:
  static constexpr int kWindow = 16;
  static constexpr double kNotable = 0.9;
  double before_ = 1, slowest_ = 0;
  int reads_ = 0;
};

}  // namespace fieldcast
