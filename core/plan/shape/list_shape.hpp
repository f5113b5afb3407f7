// Which points of a group are read together where a request carries a list of ranges. First the
// most urgent one. Then those that would need another request before the next one of this group.
// Then, with wire time to spare, those that are only better read now than later.
//
// Distance does not matter here; the limits of the request and of its answer do. Holds nothing but
// scratch memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"
#include "core/plan/shape/block_shape.hpp"
#include "core/plan/shape/point_state.hpp"
#include "core/plan/shape/selection.hpp"

namespace fieldcast {

class ListShaper {
 public:
  // `points` are one group, ordered by area and address. Cuts are respected; bad points are
  // passed over.
  void cyclic(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
              Instant now, const Allowance& allowance, const CyclicWeights& weights,
              Selection& out);
  // Every ready point of the group, as far as one request holds them: the most urgent ones.
  void whole(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
             Instant now, Selection& out);

 private:
  struct Candidate {
    Instant due;
    std::uint32_t index;  // within the group
  };
  // Begins a selection. It is confined to the part of the group that no cut separates from the
  // urgent point, and holds only that point.
  void confine(std::span<const PointState> points, std::uint32_t urgent, Instant now);
  // Takes candidates_, most urgent first, as far as the request holds them and its wire time stays
  // within `budget`.
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
