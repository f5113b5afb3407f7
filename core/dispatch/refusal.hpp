// Finds the part of a block that a device refuses: tries halves until the bad points, or the gaps
// that cannot be bridged, are known.
//
// A refused block is cut in the middle (PointState::cut_until), so that normal scheduling reads its
// halves. The cut is removed when every point of the block was acquired or found bad. If both
// halves were good, the device refused the gap between them, and the cut stays until it expires.
// Owned by the plan runner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/layout/layout.hpp"
#include "core/plan/shape/point_state.hpp"

namespace fieldcast {

class RefusalSearch {
 public:
  // `refused`: at least two points in ascending order.
  void cut(std::span<PointState> points, std::span<const OrderIndex> refused, Instant now,
           Duration forget);
  // Excludes one point until now + forget.
  void mark_bad(std::span<PointState> points, OrderIndex index, Instant now, Duration forget);
  // Points begin .. end-1 were acquired or found bad.
  void settle(std::span<PointState> points, OrderIndex begin, OrderIndex end);

  [[nodiscard]] bool searching() const { return !open_.empty(); }

 private:
  struct Node {
    OrderIndex begin, middle, end;
    bool half_refused = false;
  };
  // With more open searches, the oldest ends as if both halves were good.
  static constexpr std::size_t kMostOpen = 256;
  std::vector<Node> open_;
};

}  // namespace fieldcast
