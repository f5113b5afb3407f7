// Finds the greatest sustainable load by bisection, for the scheduler benches.
#pragma once

#include <cstddef>

#include "tools/progress/step_progress.hpp"

namespace fieldcast::bench {

constexpr double kLeastShare = 0.05;  // always sustainable
constexpr double kShareStep = 0.004;  // resolution of the result

[[nodiscard]] constexpr std::size_t trials_below(double most) {
  std::size_t trials = 0;
  for (double width = most - kLeastShare; width > kShareStep; width /= 2) ++trials;
  return trials;
}

// Assumes that `holds` is true for all smaller shares. Steps `progress` in each trial.
template <typename Holds>
[[nodiscard]] double greatest_share(double most, StepProgress& progress, const Holds& holds) {
  double good = kLeastShare;
  for (double bad = most; bad - good > kShareStep; progress.step()) {
    const double share = (good + bad) / 2;
    (holds(share) ? good : bad) = share;
  }
  return good;
}

}  // namespace fieldcast::bench
