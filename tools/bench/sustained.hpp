// The greatest load that holds, by halving: what the benches of the scheduler look for.
#pragma once

#include <cstddef>

#include "tools/progress/step_progress.hpp"

namespace fieldcast::bench {

constexpr double kLeastShare = 0.05;  // always holds
constexpr double kShareStep = 0.004;  // the share is found to within this

// How often greatest_share() tries, so often it steps the progress.
[[nodiscard]] constexpr std::size_t trials_below(double most) {
  std::size_t trials = 0;
  for (double width = most - kLeastShare; width > kShareStep; width /= 2) ++trials;
  return trials;
}

// The greatest share below `most` of which `holds(share)` is true, where all smaller ones hold too.
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
