// The sequences of one channel that were received in the present epoch of its bus. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fieldcast::web {

class ReceivedSequences {
 public:
  // The oldest run is forgotten beyond this number; its samples are then accepted again.
  static constexpr std::size_t kMaxRuns = 16;

  // Returns false for a sequence that was received before. Sequences of an earlier epoch are always
  // accepted and not kept.
  [[nodiscard]] bool add(std::uint64_t epoch, std::uint64_t sequence);

 private:
  struct Run {
    std::uint64_t first, last;  // both included
  };
  std::uint64_t epoch_ = 0;
  std::vector<Run> runs_;  // ascending, with gaps between them
};

}  // namespace fieldcast::web
