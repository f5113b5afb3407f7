// The search for what a device refuses in a block: halves are tried until the bad points, or the
// gaps that cannot be bridged, are known.
//
// A refused block is cut in the middle (PointState::cut_until), so that the ordinary scheduling
// reads its halves. When every point of the block has been acquired or found bad, the cut goes,
// unless both halves were good: then the gap between them was what the device refused, and the cut
// stays as a barrier until it is forgotten. Owned by the scheduler.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/schedule/layout.hpp"
#include "core/schedule/point_state.hpp"

namespace fieldcast {

class RefusalSearch {
 public:
  // These places (two at least, rising) were refused together at `now`.
  void cut(std::span<PointState> points, std::span<const Place> refused, std::int64_t now,
           std::int64_t forget);
  // The one point at `place` was refused: left alone until now + forget.
  void mark_bad(std::span<PointState> points, Place place, std::int64_t now, std::int64_t forget);
  // Something became known of places begin .. end-1 (acquired, or found bad): searches that are
  // complete end.
  void settle(std::span<PointState> points, Place begin, Place end);

  [[nodiscard]] bool searching() const { return !open_.empty(); }

 private:
  struct Node {
    Place begin, middle, end;
    bool half_refused = false;
  };
  static constexpr std::size_t kMostOpen =
      256;  // beyond it the oldest search ends as if both halves had been good
  std::vector<Node> open_;
};

}  // namespace fieldcast
