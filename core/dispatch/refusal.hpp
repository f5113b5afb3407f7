// The search for what a device refuses in a block: halves are tried until the bad points, or the
// gaps that cannot be bridged, are known.
//
// A refused block is cut in the middle (PointState::cut_until), so that the ordinary scheduling
// reads its halves. When every point of the block has been acquired or found bad, the cut goes,
// unless both halves were good: then the gap between them was what the device refused, and the cut
// stays as a barrier until it is forgotten. Owned by the plan runner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/layout.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

class RefusalSearch {
 public:
  // These points (two at least, rising) were refused together at `now`.
  void cut(std::span<PointState> points, std::span<const OrderIndex> refused, Instant now,
           Duration forget);
  // The one point `index` was refused: left alone until now + forget.
  void mark_bad(std::span<PointState> points, OrderIndex index, Instant now, Duration forget);
  // Something became known of points begin .. end-1 (acquired, or found bad): searches that are
  // complete end.
  void settle(std::span<PointState> points, OrderIndex begin, OrderIndex end);

  [[nodiscard]] bool searching() const { return !open_.empty(); }

 private:
  struct Node {
    OrderIndex begin, middle, end;
    bool half_refused = false;
  };
  // With more open searches, the oldest ends as if both halves had been good.
  static constexpr std::size_t kMostOpen = 256;
  std::vector<Node> open_;
};

}  // namespace fieldcast
