#include "core/schedule/list_shape.hpp"

#include <algorithm>

namespace fieldcast {

void ListShaper::confine(std::span<const PointState> points, std::uint32_t urgent,
                         std::int64_t now) {
  reach_ = {urgent, urgent + 1};
  taken_.assign(points.size(), 0);
  taken_[urgent] = 1;
  riders_.clear();
  if (points[urgent].bad) return;  // tried again: alone
  while (reach_.begin > 0 && points[reach_.begin].cut_until <= now) --reach_.begin;
  while (reach_.end < points.size() && points[reach_.end].cut_until <= now) ++reach_.end;
}

void ListShaper::cover(std::span<const PointState> points, Pick& out) const {
  out.members.clear();
  const auto& ranges = out.ranges();
  std::size_t range = 0;
  for (std::uint32_t place = reach_.begin; place < reach_.end; ++place) {
    const PointState& point = points[place];
    while (range < ranges.size() &&
           (ranges[range].area < point.area ||
            (ranges[range].area == point.area && ranges[range].end() <= point.first)))
      ++range;
    if (range == ranges.size()) return;
    const Range& held = ranges[range];
    if (held.area == point.area && held.first <= point.first && point.end <= held.end() &&
        (!point.bad || taken_[place] != 0))
      out.members.push_back(place);
  }
}

// The request for all that are taken; false when it breaks a limit.
bool ListShaper::build(std::span<const PointState> points, const ListCost& cost,
                       std::int64_t budget, Pick& out) {
  auto& ranges = out.ranges();
  ranges.clear();
  std::size_t wanted = 0;
  bool barred = false, one_area = true, no_bad = true;
  for (std::uint32_t place = reach_.begin; place < reach_.end; ++place) {
    const PointState& point = points[place];
    barred = barred || point.bad;
    if (taken_[place] == 0) continue;
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
    // One range over all may be another command, with a shorter request.
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
  out.cost = time->count();
  return wanted == 1 || out.cost <= budget;
}

void ListShaper::take(std::span<const PointState> points, const ListCost& cost, std::int64_t budget,
                      Pick& out) {
  if (riders_.empty()) return;
  const auto mark = [&](std::size_t from, std::size_t to, std::uint8_t how) {
    for (std::size_t i = from; i < to; ++i) taken_[riders_[i].place] = how;
  };
  std::size_t fits = 0, fails = riders_.size() + 1, marked = 0;
  std::size_t attempt = riders_.size(), built = 0;
  bool sorted = false;
  while (fits + 1 < fails) {
    if (attempt > marked) mark(marked, attempt, 1);
    if (attempt < marked) mark(attempt, marked, 0);
    marked = attempt;
    (build(points, cost, budget, out) ? fits : fails) = built = attempt;
    if (!sorted && fails != riders_.size() + 1) {
      // Not all of them: then the most urgent ones.
      mark(0, marked, 0);
      marked = 0;
      std::sort(riders_.begin(), riders_.end(),
                [](const Rider& a, const Rider& b) { return a.due < b.due; });
      sorted = true;
    }
    attempt = (fits + fails) / 2;
  }
  if (marked > fits) mark(fits, marked, 0);
  if (built != fits) build(points, cost, kNeverNs, out);
  riders_.clear();
}

void ListShaper::riding(std::span<const PointState> points, std::uint32_t urgent,
                        const ListCost& cost, std::int64_t now, const Allowance& allowance,
                        const RidingWeights& weights, Pick& out) {
  const std::int64_t next_read = next_turn(points, urgent, now, allowance, weights);
  confine(points, urgent, now);
  build(points, cost, kNeverNs, out);
  const auto collect = [&](const auto& comes) {
    for (std::uint32_t place = reach_.begin; place < reach_.end; ++place) {
      const PointState& point = points[place];
      if (taken_[place] == 0 && !point.bad && point.ready(now) && comes(point))
        riders_.push_back({point.due, place});
    }
  };
  collect([&](const PointState& point) { return point.due <= next_read; });
  take(points, cost, kNeverNs, out);
  if (allowance.budget > 0) {
    collect([&](const PointState& point) { return point.due <= next_read || point.eager; });
    take(points, cost, allowance.budget, out);
  }
  cover(points, out);
}

void ListShaper::whole(std::span<const PointState> points, std::uint32_t urgent,
                       const ListCost& cost, std::int64_t now, Pick& out) {
  confine(points, urgent, now);
  build(points, cost, kNeverNs, out);
  for (std::uint32_t place = reach_.begin; place < reach_.end; ++place) {
    if (place != urgent && !points[place].bad && points[place].ready(now))
      riders_.push_back({points[place].due, place});
  }
  take(points, cost, kNeverNs, out);
  cover(points, out);
}

}  // namespace fieldcast
