#include "core/plan/shape/read_selector.hpp"

#include <algorithm>
#include <numeric>

namespace fieldcast {

namespace {

// Without rests, neighbours with equal refresh are always read together.
bool all_intensive_alike(std::span<const PointState> points) {
  return std::ranges::all_of(points, [&](const PointState& point) {
    return point.mode == Mode::kIntensive && point.allowed_gap == points.front().allowed_gap;
  });
}

}  // namespace

Slice ReadSelector::slice_of(const ReadCost& cost, std::span<const PointState> points,
                             std::uint32_t urgent, Instant now, const Allowance& allowance) const {
  switch (rule_) {
    case ShapeRule::kCyclic:
      if (points[urgent].mode == Mode::kIntensive && all_intensive_alike(points))
        return whole_slice(points, urgent, cost, now);
      return cyclic_slice(points, urgent, cost, now, allowance, weights_);
    case ShapeRule::kNear: return near_slice(points, urgent, cost, now);
    case ShapeRule::kSingle: return {urgent, urgent + 1};
    case ShapeRule::kWhole: break;
  }
  return whole_slice(points, urgent, cost, now);
}

const Selection& ReadSelector::select(const Layout& layout, const Group& group,
                                      std::span<const PointState> points, std::uint32_t urgent,
                                      Instant now, const Allowance& allowance) {
  if (group.list) {
    const ListCost& cost = *layout.lists[group.device];
    if (points[urgent].mode == Mode::kIntensive && all_intensive_alike(points))
      lists_.whole(points, urgent, cost, now, selection_);
    else
      lists_.cyclic(points, urgent, cost, now, allowance, weights_, selection_);
    return selection_;
  }
  const ReadCost& cost = layout.area_runs[group.area_run].cost;
  const Slice slice = slice_of(cost, points, urgent, now, allowance);
  const Range range = range_of(points, slice, cost);
  selection_.members.resize(slice.end - slice.begin);
  std::iota(selection_.members.begin(), selection_.members.end(), slice.begin);
  selection_.ranges().assign(1, range);
  selection_.cost = cost.of(range);
  return selection_;
}

Duration ReadSelector::cost_of(const Layout& layout, const Group& group,
                               std::span<const PointState> points, std::uint32_t urgent,
                               Instant now, const Allowance& allowance) {
  if (group.list) return select(layout, group, points, urgent, now, allowance).cost;
  const ReadCost& cost = layout.area_runs[group.area_run].cost;
  return cost.of(range_of(points, slice_of(cost, points, urgent, now, allowance), cost));
}

}  // namespace fieldcast
