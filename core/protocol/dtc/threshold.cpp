#include "core/protocol/dtc/threshold.hpp"

#include <cmath>

namespace fieldcast::dtc {

std::size_t auto_threshold(const LineFormat& line, Duration per_byte) {
  // Fraction saved once strings repeat; dtc_bench prints the gain on real data.
  constexpr double kSaved = 0.5;
  constexpr double kLearning = 16.0;  // bytes without a gain
  constexpr double kLengthBytes = 2.0;
  const double character = static_cast<double>(line.characters(1).count());
  const double gain = kSaved * character - static_cast<double>(per_byte.count());
  if (gain <= 0) return kNever;
  const double least = std::ceil((kSaved * kLearning + kLengthBytes) * character / gain);
  return least < static_cast<double>(kNever) ? static_cast<std::size_t>(least) : kNever;
}

}  // namespace fieldcast::dtc
