// How much sooner than planned the reads of a device end. A line behind a converter, or a
// pseudo-terminal, carries characters faster than its rate says; who began in time for the rate
// would be done long before the turn, and read again. Plain value.
#pragma once

#include <algorithm>
#include <cstdint>

namespace fieldcast {

class LinePace {
 public:
  // A read that was planned to take `planned` ns until its answer ended took `took`.
  void read(std::int64_t took, std::int64_t planned) {
    if (planned <= 0) return;
    const double share = static_cast<double>(took) / static_cast<double>(planned);
    slowest_ = std::max(slowest_, std::min(share, 1.0));
    if (++reads_ < kWindow) return;
    before_ = slowest_;
    slowest_ = 0;
    reads_ = 0;
  }
  // Of the planned time, at most 1: the slowest of the last reads. Small differences are no pace of
  // the line.
  [[nodiscard]] double share() const {
    const double share = std::max(before_, slowest_);
    return share < kNotable ? share : 1.0;
  }
  [[nodiscard]] std::int64_t of(std::int64_t planned) const {
    const double paced = share();
    return paced < 1 ? static_cast<std::int64_t>(paced * static_cast<double>(planned)) : planned;
  }

 private:
  static constexpr int kWindow = 16;
  static constexpr double kNotable = 0.9;
  double before_ = 1, slowest_ = 0;
  int reads_ = 0;
};

}  // namespace fieldcast
