#pragma once

#include <cstddef>
#include <cstdint>

#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {

constexpr double kLeastShare = 0.05;  // always sustainable
constexpr double kShareStep = 0.001;  // resolution of the result

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

// Random maps: `fieldcast plan` and `--simulate` must agree.
void print_agreement(std::uint64_t first_seed, unsigned maps);

// The sustained load of engine and scheduler, on maps not used for tuning.
void print_engine(std::uint64_t first_seed, unsigned maps);

// The share of what any master can sustain, and the share of the wire lost to each cause. `engine`:
// false measures the scheduler alone, which is faster.
void print_losses(std::uint64_t first_seed, unsigned maps, bool engine);

}  // namespace fieldcast::bench
