// Which points the next read of a group holds, and the request for them. Holds scratch memory and
// the rule of its planner; a copy selects the same.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/layout.hpp"
#include "core/plan/shape/block_shape.hpp"
#include "core/plan/shape/list_shape.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/selection.hpp"

namespace fieldcast {

// Which neighbours are read with the most urgent point.
enum class ShapeRule : std::uint8_t {
  kCyclic,  // those that are due before the group is read again; lists of ranges where possible
  kNear,    // those that have used up half of their allowed gap
  kWhole,   // all of the group
  kSingle,  // none
};

class ReadSelector {
 public:
  explicit ReadSelector(ShapeRule rule, const CyclicWeights& weights = {})
      : rule_(rule), weights_(weights) {}

  // `points` are those of `group`; `urgent` is an index within it. The result is valid until the
  // next call.
  const Selection& select(const Layout& layout, const Group& group,
                          std::span<const PointState> points, std::uint32_t urgent, Instant now,
                          const Allowance& allowance);
  // Only the wire time of that read.
  [[nodiscard]] Duration cost_of(const Layout& layout, const Group& group,
                                 std::span<const PointState> points, std::uint32_t urgent,
                                 Instant now, const Allowance& allowance);

 private:
  [[nodiscard]] Slice slice_of(const ReadCost& cost, std::span<const PointState> points,
                               std::uint32_t urgent, Instant now, const Allowance& allowance) const;

  ShapeRule rule_;
  CyclicWeights weights_;
  ListShaper lists_;
  Selection selection_;
};

}  // namespace fieldcast
