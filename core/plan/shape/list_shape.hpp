// Selects the points of a group that are read together with a list of ranges. The most urgent point
// is first. Then follow those that would otherwise need a request before the group's next one. With
// spare wire time, points that are better read now than later are added. The limits of request and
// response matter, distance does not. Holds only scratch memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/layout/list_cost.hpp"
#include "core/plan/shape/block_shape.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/selection.hpp"

namespace fieldcast {

class ListShaper {
 public:
  // `points`: one group, ordered by area and address. Respects cuts; skips bad points.
  void cyclic(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
              Instant now, const Allowance& allowance, const CyclicWeights& weights,
              Selection& out);
  void whole(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
             Instant now, Selection& out);

 private:
  struct Candidate {
    Instant due;
    std::uint32_t index;  // within the group
  };
  // Starts a selection with the urgent point, limited by cuts.
  void confine(std::span<const PointState> points, std::uint32_t urgent, Instant now);
  // Adds the most urgent points first, within the limits of the request and `budget`.
  void take(std::span<const PointState> points, const ListCost& cost, Duration budget,
            Selection& out);
  bool build(std::span<const PointState> points, const ListCost& cost, Duration budget,
             Selection& out);
  void cover(std::span<const PointState> points, Selection& out) const;

  Slice reach_{};
  std::vector<Candidate> candidates_;
  std::vector<std::uint8_t> taken_;  // by index within the group
  Selection attempt_;
};

}  // namespace fieldcast
