#include "core/schedule/block_shape.hpp"

#include <algorithm>

namespace fieldcast {

namespace {

std::int64_t part(double share, std::int64_t of) {
  return static_cast<std::int64_t>(share * static_cast<double>(of));
}

// Grows a slice one neighbour at a time, in one direction, and keeps the best place to stop.
class Growth {
 public:
  Growth(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
         std::int64_t now)
      : points_(points),
        cost_(cost),
        now_(now),
        slice_{urgent, urgent + 1},
        first_(points[urgent].first),
        end_(points[urgent].end) {}

  // `worth(point)`: wire time that renewing the point now is worth. `rescue`: the largest worth
  // that may still come. `budget`: of the whole block.
  template <typename Worth>
  void grow(bool up, const Worth& worth, double rescue, std::int64_t budget) {
    double balance = 0;
    std::uint32_t first = first_, end = end_;
    for (std::uint32_t at = up ? slice_.end : slice_.begin; up ? at < points_.size() : at > 0;
         at += up ? 1 : 0) {
      const std::uint32_t place = up ? at : --at;
      const bool cut = up ? cut_between(points_[place - 1], points_[place], now_)
                          : cut_between(points_[place], points_[place + 1], now_);
      if (cut) return;
      const std::uint32_t before = end - first;
      first = std::min(first, points_[place].first);
      end = std::max(end, points_[place].end);
      const Range range = cost_.cover(first, end);
      if (!cost_.fits(range) || cost_.of(range).count() > budget) return;
      balance -= cost_.item_ns() * (end - first - before);
      if (points_[place].ready(now_)) balance += worth(points_[place]);
      if (balance >= 0) {
        (up ? slice_.end : slice_.begin) = up ? place + 1 : place;
        first_ = first;
        end_ = end;
        balance = 0;
      } else if (balance + rescue < 0) {
        return;
      }
    }
  }
  template <typename Worth>
  void both_ways(const Worth& worth, double rescue, std::int64_t budget) {
    grow(true, worth, rescue, budget);
    grow(false, worth, rescue, budget);
  }
  [[nodiscard]] Slice slice() const { return slice_; }

 private:
  std::span<const PointState> points_;
  const ReadCost& cost_;
  std::int64_t now_;
  Slice slice_;
  std::uint32_t first_, end_;
};

}  // namespace

std::int64_t next_turn(std::span<const PointState> points, std::uint32_t urgent, std::int64_t now,
                       const Allowance& allowance, const RidingWeights& weights) {
  std::int64_t beat = allowance.spacing, base = std::max(now, points[urgent].due);
  if (beat == 0) {
    beat = points[urgent].period;
    base = now;
    for (const PointState& point : points) {
      if (point.ready(now)) beat = std::min(beat, point.period);
    }
  }
  return base + part(weights.reach, beat);
}

Slice riding_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                   std::int64_t now, const Allowance& allowance, const RidingWeights& weights) {
  const std::int64_t next_read = next_turn(points, urgent, now, allowance, weights);
  // Whoever is due comes along, or would need a request of its own; what is between is on the way.
  constexpr double kAnything = 1e18;
  const double request = cost.item_ns() * cost.bridge();
  const auto must = [&](const PointState& point) {
    return point.due <= next_read ? kAnything : 0.0;
  };
  const auto eager = [&](const PointState& point) {
    return point.due <= next_read ? kAnything
           : point.eager          ? request + cost.item_ns() * (point.end - point.first)
                                  : 0.0;
  };
  Growth growth(points, urgent, cost, now);
  growth.both_ways(must, kAnything, kNeverNs);
  if (allowance.budget > 0) growth.both_ways(eager, request, allowance.budget);
  return growth.slice();
}

Slice near_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                 std::int64_t now) {
  Growth growth(points, urgent, cost, now);
  const double request = cost.item_ns() * cost.bridge();
  const auto half_used = [&](const PointState& point) {
    return point.used(now) >= 0.5 ? request : 0.0;
  };
  growth.both_ways(half_used, request, kNeverNs);
  return growth.slice();
}

Slice whole_slice(std::span<const PointState> points, std::uint32_t urgent, const ReadCost& cost,
                  std::int64_t now) {
  Growth growth(points, urgent, cost, now);
  constexpr double kAnything = 1e18;
  growth.both_ways([](const PointState&) { return kAnything; }, kAnything, kNeverNs);
  return growth.slice();
}

Range range_of(std::span<const PointState> points, Slice slice, const ReadCost& cost) {
  std::uint32_t end = 0;
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) end = std::max(end, points[i].end);
  return cost.cover(points[slice.begin].first, end);
}

}  // namespace fieldcast
