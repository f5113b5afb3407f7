// Which points of a cluster are read together where a request carries a list of ranges: the most
// urgent one first, then those that would need another request before the next one of this cluster,
// then, with wire time to spare, those that are only better read now than later.
//
// Nobody is too far away; what limits a read is what the request and its answer hold. Pure but for
// its scratch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/list_cost.hpp"
#include "core/schedule/block_shape.hpp"
#include "core/schedule/pick.hpp"
#include "core/schedule/point_state.hpp"

namespace fieldcast {

class ListShaper {
 public:
  // `points` are one cluster, ordered by area and address. Cuts are respected; bad points are
  // passed over.
  void riding(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
              std::int64_t now, const Allowance& allowance, const RidingWeights& weights,
              Pick& out);
  // Every ready point of the cluster, as far as one request holds them: the most urgent ones.
  void whole(std::span<const PointState> points, std::uint32_t urgent, const ListCost& cost,
             std::int64_t now, Pick& out);

 private:
  struct Rider {
    std::int64_t due;
    std::uint32_t place;
  };
  // Starts a choice: the part of the cluster that no cut parts from the urgent point, of which only
  // that is taken.
  void confine(std::span<const PointState> points, std::uint32_t urgent, std::int64_t now);
  // Takes riders_, most urgent first, as far as the request holds them and its wire time keeps
  // within `budget`.
  void take(std::span<const PointState> points, const ListCost& cost, std::int64_t budget,
            Pick& out);
  bool build(std::span<const PointState> points, const ListCost& cost, std::int64_t budget,
             Pick& out);
  void cover(std::span<const PointState> points, Pick& out) const;

  Slice reach_{};
  std::vector<Rider> riders_;
  std::vector<std::uint8_t> taken_;  // by place of the cluster
  Pick attempt_;
};

}  // namespace fieldcast
