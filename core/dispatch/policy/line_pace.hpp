// How much earlier than planned the reads of a device end. A converter or pseudo-terminal is faster
// than its nominal rate: a read planned for that rate would end too early and be repeated. Plain
// value.
#pragma once

#include <algorithm>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

class LinePace {
 public:
  // `took`, `planned`: time until the end of the response.
  void read(Duration took, Duration planned) {
    if (planned <= Duration::zero()) return;
    const double share = ns(took) / ns(planned);
    slowest_ = std::max(slowest_, std::min(share, 1.0));
    if (++reads_ < kWindow) return;
    before_ = slowest_;
    slowest_ = 0;
    reads_ = 0;
  }
  // At most 1: the slowest of the last reads. Ignores small differences.
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
