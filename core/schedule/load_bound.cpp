#include "core/schedule/load_bound.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "core/plan/layout/partition.hpp"
#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

namespace {

using PointsByArea = std::map<std::pair<DeviceIndex, AreaIndex>, std::vector<PointIndex>>;

// Points that are read by themselves by device and area, each in order of addresses.
PointsByArea points_by_area(const ScheduleInput& input) {
  PointsByArea areas;
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    const Point& from = input.points[point];
    if (from.mode != Mode::kOnDemand) areas[{from.device, from.range.area}].push_back(point);
  }
  for (auto& [area, points] : areas) {
    std::ranges::sort(points, {}, [&](PointIndex point) {
      const Range& range = input.points[point].range;
      return std::tuple(range.first, range.end(), point);
    });
  }
  return areas;
}

bool lists_ranges(const ScheduleInput& input, DeviceIndex device, AreaIndex area) {
  const DeviceTiming& timing = input.devices[device];
  return ListCost::can_list(*timing.protocol) &&
         ListCost(timing, input.line, input.silence).lists(area);
}

ReadCost cost_in(const ScheduleInput& input, std::span<const PointIndex> points) {
  const Point& head = input.points[points.front()];
  std::uint32_t end = 0;
  for (const PointIndex point : points) end = std::max(end, input.points[point].range.end());
  return {input.devices[head.device], head.range.area, input.line, input.silence,
          end - head.range.first};
}

// Calls `check(price, cost)` for every request that begins at a point and ends with one: the prices
// of the points in it, and what it costs. `points`: of one area, by address.
template <typename Check>
void for_requests(const ScheduleInput& input, std::span<const PointIndex> points,
                  std::span<const Duration> prices, const Check& check) {
  const ReadCost cost = cost_in(input, points);
  std::vector<PointIndex> inside;
  for (std::size_t begin = 0; begin < points.size(); ++begin) {
    const std::uint32_t first = input.points[points[begin]].range.first;
    const std::uint32_t covered = cost.cover(first, first + 1).first;
    inside.clear();
    for (const PointIndex point : points) {
      const Range& range = input.points[point].range;
      const bool alone = point == points[begin];
      if (range.first >= covered && (alone || cost.fits(cost.cover(first, range.end()))))
        inside.push_back(point);
    }
    std::ranges::sort(inside, {},
                      [&](PointIndex point) { return input.points[point].range.end(); });
    Duration price{};
    for (const PointIndex point : inside) {
      price += prices[point];
      const auto range = cost.cover(first, std::max(first + 1, input.points[point].range.end()));
      if (const auto time = cost.of_single(range)) check(price, *time);
    }
  }
}

// A point pays what it adds to the cheapest requests for all points with shorter refreshes. These
// are the best prices if a point adds less to more others.
void set_prices(const ScheduleInput& input, std::span<const PointIndex> points,
                std::vector<Duration>& prices) {
  const ReadCost cost = cost_in(input, points);
  std::vector<PointIndex> order(points.begin(), points.end());
  std::ranges::stable_sort(order, {},
                           [&](PointIndex point) { return input.points[point].refresh; });
  std::vector<Wanted> wanted;
  Duration before{};
  for (const PointIndex point : order) {
    const Range& range = input.points[point].range;
    const Wanted added{range.first, range.end()};
    const auto at = std::ranges::upper_bound(
        wanted, std::pair(added.first, added.end), {},
        [](const Wanted& each) { return std::pair(each.first, each.end); });
    wanted.insert(at, added);
    const Duration now = cost_of(wanted, optimal_partition(wanted, cost), cost);
    prices[point] = std::max(Duration::zero(), now - before);
    before = now;
  }
}

// Lowers all prices of an area until no request costs less than its points.
void make_valid(const ScheduleInput& input, std::span<const PointIndex> points,
                std::vector<Duration>& prices) {
  double share = 1;
  for_requests(input, points, prices, [&](Duration price, Duration cost) {
    if (price > cost) share = std::min(share, ns(cost) / ns(price));
  });
  if (share == 1) return;
  constexpr double kRounding = 1e-12;
  for (const PointIndex point : points) prices[point] = part_of(share - kRounding, prices[point]);
}

}  // namespace

std::optional<LoadBound> load_bound_of(const ScheduleInput& input) {
  constexpr std::size_t kMany = 2000;
  LoadBound bound;
  bound.prices.resize(input.points.size());
  for (const auto& [area, points] : points_by_area(input)) {
    if (points.size() > kMany || lists_ranges(input, area.first, area.second)) return std::nullopt;
    set_prices(input, points, bound.prices);
    make_valid(input, points, bound.prices);
  }
  const auto proven = proven_load(input, bound.prices);
  if (!proven) return std::nullopt;
  bound.load = *proven;
  return bound;
}

std::optional<double> proven_load(const ScheduleInput& input, std::span<const Duration> prices) {
  if (prices.size() != input.points.size()) return std::nullopt;
  bool valid = true;
  double load = 0;
  for (const auto& [area, points] : points_by_area(input)) {
    if (lists_ranges(input, area.first, area.second)) return std::nullopt;
    for_requests(input, points, prices,
                 [&](Duration price, Duration cost) { valid = valid && price <= cost; });
    for (const PointIndex point : points) {
      valid = valid && prices[point] >= Duration::zero();
      load += ns(prices[point]) / ns(input.points[point].refresh);
    }
  }
  return valid ? std::optional(load) : std::nullopt;
}

}  // namespace fieldcast
