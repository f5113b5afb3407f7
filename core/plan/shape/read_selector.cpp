#include "core/plan/shape/read_selector.hpp"

#include <algorithm>
#include <numeric>

namespace fieldcast {

void ListShaper::confine(std::span<const PointState> points, std::uint32_t urgent, Instant now) {
  reach_ = {urgent, urgent + 1};
  taken_.assign(points.size(), 0);
  taken_[urgent] = 1;
  candidates_.clear();
  if (points[urgent].bad) return;  // tried again, alone
  while (reach_.begin > 0 && points[reach_.begin].cut_until <= now) --reach_.begin;
  while (reach_.end < points.size() && points[reach_.end].cut_until <= now) ++reach_.end;
}

void ListShaper::cover(std::span<const PointState> points, Selection& out) const {
  out.members.clear();
  const auto& ranges = out.ranges();
  std::size_t range = 0;
  for (std::uint32_t index = reach_.begin; index < reach_.end; ++index) {
    const PointState& point = points[index];
    while (range < ranges.size() &&
           (ranges[range].area < point.area ||
            (ranges[range].area == point.area && ranges[range].end() <= point.first)))
      ++range;
    if (range == ranges.size()) return;
    const Range& held = ranges[range];
    if (held.area == point.area && held.first <= point.first && point.end <= held.end() &&
        (!point.bad || taken_[index] != 0))
      out.members.push_back(index);
  }
}

// Returns false if the request exceeds a limit.
bool ListShaper::build(std::span<const PointState> points, const ListCost& cost, Duration budget,
                       Selection& out) {
  auto& ranges = out.ranges();
  ranges.clear();
  std::size_t wanted = 0;
  bool barred = false, one_area = true, no_bad = true;
  for (std::uint32_t index = reach_.begin; index < reach_.end; ++index) {
    const PointState& point = points[index];
    barred = barred || point.bad;
    if (taken_[index] == 0) continue;
    ++wanted;
    no_bad = no_bad && (!barred || ranges.empty());
    if (!ranges.empty() && !barred &&
        cost.joins(ranges.back(), point.area, point.first, point.end)) {
      ranges.back().count = std::max(ranges.back().end(), point.end) - ranges.back().first;
      continue;
    }
    one_area = one_area && (ranges.empty() || ranges.back().area == point.area);
    ranges.push_back({point.area, point.first, point.end - point.first});
    barred = false;
  }
  auto time = cost.of(out.request, wanted == 1);
  if (ranges.size() > 1 && one_area && no_bad) {
    // One range over all may use another command, with a shorter request.
    std::uint32_t end = 0;
    for (const Range& range : ranges) end = std::max(end, range.end());
    Request& single = attempt_.request;
    attempt_.ranges().assign(
        1, {ranges.front().area, ranges.front().first, end - ranges.front().first});
    const auto other = cost.of(single);
    if (other && (!time || *other < *time)) {
      time = other;
      ranges = attempt_.ranges();
    }
  }
  if (!time) return false;
  out.cost = *time;
  return wanted == 1 || out.cost <= budget;
}

void ListShaper::take(std::span<const PointState> points, const ListCost& cost, Duration budget,
                      Selection& out) {
  if (candidates_.empty()) return;
  const auto mark = [&](std::size_t from, std::size_t to, std::uint8_t how) {
    for (std::size_t i = from; i < to; ++i) taken_[candidates_[i].index] = how;
  };
  std::size_t fits = 0, fails = candidates_.size() + 1, marked = 0;
  std::size_t attempt = candidates_.size(), built = 0;
  bool sorted = false;
  while (fits + 1 < fails) {
    if (attempt > marked) mark(marked, attempt, 1);
    if (attempt < marked) mark(attempt, marked, 0);
    marked = attempt;
    (build(points, cost, budget, out) ? fits : fails) = built = attempt;
    if (!sorted && fails != candidates_.size() + 1) {
      // Not all of them fit: selects the most urgent ones.
      mark(0, marked, 0);
      marked = 0;
      std::ranges::sort(candidates_,
                        [](const Candidate& a, const Candidate& b) { return a.due < b.due; });
      sorted = true;
    }
    attempt = (fits + fails) / 2;
  }
  if (marked > fits) mark(fits, marked, 0);
  if (built != fits) build(points, cost, Duration::max(), out);
  candidates_.clear();
}

void ListShaper::cyclic(std::span<const PointState> points, std::uint32_t urgent,
                        const ListCost& cost, Instant now, const Allowance& allowance,
                        const CyclicWeights& weights, Selection& out) {
  const JoinRule rule = join_rule(points, urgent, now, allowance, weights);
  confine(points, urgent, now);
  build(points, cost, Duration::max(), out);
  const auto collect = [&](const auto& comes) {
    for (std::uint32_t index = reach_.begin; index < reach_.end; ++index) {
      const PointState& point = points[index];
      if (taken_[index] == 0 && !point.bad && point.ready(now) && comes(point))
        candidates_.push_back({point.due, index});
    }
  };
  collect([&](const PointState& point) { return rule.joins(point); });
  take(points, cost, Duration::max(), out);
  if (allowance.budget > Duration::zero()) {
    collect([&](const PointState& point) { return rule.joins(point) || point.eager; });
    take(points, cost, allowance.budget, out);
  }
  cover(points, out);
}

void ListShaper::whole(std::span<const PointState> points, std::uint32_t urgent,
                       const ListCost& cost, Instant now, Selection& out) {
  confine(points, urgent, now);
  build(points, cost, Duration::max(), out);
  for (std::uint32_t index = reach_.begin; index < reach_.end; ++index) {
    if (index != urgent && !points[index].bad && points[index].ready(now))
      candidates_.push_back({points[index].due, index});
  }
  take(points, cost, Duration::max(), out);
  cover(points, out);
}

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
