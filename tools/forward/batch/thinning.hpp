// The first step when the queue is full: of each channel, one sample a minute is kept. Pure.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

class Thinning {
 public:
  // Keeps the first sample of each channel and minute (of acquired_at), and removes the others.
  // Returns how many it has removed. REQUIRES: batches in the order of the queue.
  std::size_t thin(SampleBatch& batch);

 private:
  static constexpr std::size_t kMaxChannels = 400'000;  // then the memory starts again

  std::unordered_map<std::uint64_t, std::int64_t> minutes_;  // last kept minute of each channel
};

}  // namespace fieldcast::forward
