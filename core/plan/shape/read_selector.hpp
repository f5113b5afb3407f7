// Selects the points of a group's next read and builds its request. Holds scratch memory.
#pragma once

#include <cstdint>
#include <span>

#include "core/plan/layout/layout.hpp"
#include "core/plan/shape/block_shape.hpp"
#include "core/plan/shape/list_shape.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/selection.hpp"

namespace fieldcast {

enum class ShapeRule : std::uint8_t {
  kCyclic,  // those due before the group is read again; lists of ranges if possible
  kNear,    // those that have used half of their allowed gap
  kWhole,   // the whole group
  kSingle,  // none
};

class ReadSelector {
 public:
  explicit ReadSelector(ShapeRule rule, const CyclicWeights& weights = {})
      : rule_(rule), weights_(weights) {}

  // `points`: those of `group`; `urgent`: index within it. The result is valid until the next call.
  const Selection& select(const Layout& layout, const Group& group,
                          std::span<const PointState> points, std::uint32_t urgent, Instant now,
                          const Allowance& allowance);
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
