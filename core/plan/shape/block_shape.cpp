#include "core/plan/shape/block_shape.hpp"

#include <algorithm>

namespace fieldcast {

namespace {

// Grows a slice by one neighbour at a time, in one direction, and keeps the best end so far.
class Growth {
 public:
  Growth(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
         Instant now)
      : points_(points),
        cost_(cost),
        now_(now),
        slice_{urgent, urgent + 1},
        first_(points[urgent].first),
        end_(points[urgent].end) {}

  // `worth(point)`: wire time saved by reading it now. `rescue`: limit of what later points add.
  template <typename Worth>
  void grow(bool up, const Worth& worth, double rescue, Duration budget) {
    double balance = 0;
    std::uint32_t first = first_, end = end_;
    for (std::uint32_t at = up ? slice_.end : slice_.begin; up ? at < points_.size() : at > 0;
         at += up ? 1 : 0) {
      const std::uint32_t index = up ? at : --at;
      const bool cut = up ? cut_between(points_[index - 1], points_[index], now_)
                          : cut_between(points_[index], points_[index + 1], now_);
      if (cut) return;
      const std::uint32_t before = end - first;
      first = std::min(first, points_[index].first);
      end = std::max(end, points_[index].end);
      const Range range = cost_.cover(first, end);
      if (!cost_.fits(range) || cost_.of(range) > budget) return;
      balance -= cost_.item_ns() * (end - first - before);
      if (points_[index].ready(now_)) balance += worth(points_[index]);
      if (balance >= 0) {
        (up ? slice_.end : slice_.begin) = up ? index + 1 : index;
        first_ = first;
        end_ = end;
        balance = 0;
      } else if (balance + rescue < 0) {
        return;
      }
    }
  }
  template <typename Worth>
  void both_ways(const Worth& worth, double rescue, Duration budget) {
    grow(true, worth, rescue, budget);
    grow(false, worth, rescue, budget);
  }
  [[nodiscard]] Slice slice() const { return slice_; }

 private:
  std::span<const PointState> points_;
  const ReadCost& cost_;
  Instant now_;
  Slice slice_;
  std::uint32_t first_, end_;
};

}  // namespace

JoinRule join_rule(std::span<const PointState> points, std::uint32_t urgent, Instant now,
                   const Allowance& allowance, const CyclicWeights& weights) {
  if (allowance.period != Duration::zero()) {
    const Instant end = std::max(now, points[urgent].due);
    return {end + part_of(weights.reach, allowance.period), end + allowance.period};
  }
  Duration shortest = points[urgent].allowed_gap;
  for (const PointState& point : points) {
    if (point.ready(now)) shortest = std::min(shortest, point.allowed_gap);
  }
  const Instant until = now + part_of(weights.reach, shortest);
  return {until, until};
}

Slice cyclic_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                   Instant now, const Allowance& allowance, const CyclicWeights& weights) {
  const JoinRule rule = join_rule(points, urgent, now, allowance, weights);
  // A due point would need a separate request otherwise.
  constexpr double kAnything = 1e18;
  const double request = cost.item_ns() * cost.bridge();
  const auto must = [&](const PointState& point) { return rule.joins(point) ? kAnything : 0.0; };
  const auto eager = [&](const PointState& point) {
    return rule.joins(point) ? kAnything
           : point.eager     ? request + cost.item_ns() * (point.end - point.first)
                             : 0.0;
  };
  Growth growth(points, urgent, cost, now);
  growth.both_ways(must, kAnything, Duration::max());
  if (allowance.budget > Duration::zero()) growth.both_ways(eager, request, allowance.budget);
  return growth.slice();
}

Slice near_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                 Instant now) {
  Growth growth(points, urgent, cost, now);
  const double request = cost.item_ns() * cost.bridge();
  const auto half_used = [&](const PointState& point) {
    return point.used(now) >= 0.5 ? request : 0.0;
  };
  growth.both_ways(half_used, request, Duration::max());
  return growth.slice();
}

Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                  Instant now) {
  Growth growth(points, urgent, cost, now);
  constexpr double kAnything = 1e18;
  growth.both_ways([](const PointState&) { return kAnything; }, kAnything, Duration::max());
  return growth.slice();
}

Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost) {
  std::uint32_t end = 0;
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) end = std::max(end, points[i].end);
  return cost.cover(points[slice.begin].first, end);
}

}  // namespace fieldcast
