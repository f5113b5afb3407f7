#include "core/plan/layout/layout.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/plan/layout/pack.hpp"
#include "core/plan/layout/partition.hpp"

namespace fieldcast {

namespace {

void add_group(Grouping& grouping, const Group& group) {
  const auto index = static_cast<GroupIndex>(grouping.groups.size());
  grouping.group_at.insert(grouping.group_at.end(), group.end - group.begin, index);
  grouping.groups_of[group.device].push_back(index);
  grouping.groups.push_back(group);
}

// Sets `stays` to false for points in packs.
std::vector<std::vector<PointIndex>> packs_of(const ScheduleInput& input, const Layout& layout,
                                              DeviceIndex device, std::vector<bool>& stays) {
  const ListCost& cost = *layout.lists[device];
  std::vector<AreaPoints> areas;
  for (const AreaRun& run : layout.area_runs) {
    if (run.device != device || !cost.lists(run.area)) continue;
    areas.push_back({std::span(layout.point_at).subspan(run.begin, run.end - run.begin), run.cost});
  }
  auto packs = make_packs(input.points, areas, cost);
  for (const auto& pack : packs) {
    for (const PointIndex point : pack) stays[point] = false;
  }
  return packs;
}

void move_packs(const ScheduleInput& input, Layout& layout) {
  std::vector<bool> stays(input.points.size(), true);
  std::vector<std::pair<DeviceIndex, std::vector<PointIndex>>> packs;
  for (DeviceIndex device = 0; device < input.devices.size(); ++device) {
    if (!ListCost::can_list(*input.devices[device].protocol)) continue;
    layout.lists[device].emplace(input.devices[device], input.line, input.silence);
    for (auto& points : packs_of(input, layout, device, stays))
      packs.emplace_back(device, std::move(points));
  }
  if (packs.empty()) return;
  std::vector<AreaRunIndex> area_run_of(input.points.size());
  for (OrderIndex index = 0; index < layout.point_at.size(); ++index)
    area_run_of[layout.point_at[index]] = layout.area_run_at[index];
  std::vector<PointIndex> point_at;
  for (AreaRun& run : layout.area_runs) {
    const auto begin = static_cast<OrderIndex>(point_at.size());
    for (OrderIndex index = run.begin; index < run.end; ++index) {
      if (stays[layout.point_at[index]]) point_at.push_back(layout.point_at[index]);
    }
    run.begin = begin;
    run.end = static_cast<OrderIndex>(point_at.size());
  }
  for (const auto& [device, points] : packs) {
    const auto begin = static_cast<OrderIndex>(point_at.size());
    point_at.insert(point_at.end(), points.begin(), points.end());
    layout.packs.push_back({area_run_of[points.front()], device, begin,
                            static_cast<OrderIndex>(point_at.size()), true});
  }
  layout.point_at = std::move(point_at);
  for (OrderIndex index = 0; index < layout.point_at.size(); ++index)
    layout.area_run_at[index] = area_run_of[layout.point_at[index]];
}

std::vector<PointIndex> ordered(std::span<const Point> points) {
  std::vector<PointIndex> order(points.size());
  std::iota(order.begin(), order.end(), PointIndex{0});
  std::ranges::sort(order, [&](PointIndex a, PointIndex b) {
    const Point &p = points[a], &q = points[b];
    return std::tuple(p.device, p.range.area, p.range.first, p.range.end(), a) <
           std::tuple(q.device, q.range.area, q.range.first, q.range.end(), b);
  });
  return order;
}

}  // namespace

Grouping make_groups(const Layout& layout, std::span<const Wanted> wanted,
                     std::span<const double> rates) {
  Grouping grouping;
  grouping.groups_of.resize(layout.lists.size());
  for (AreaRunIndex index = 0; index < layout.area_runs.size(); ++index) {
    const AreaRun& run = layout.area_runs[index];
    for (const Slice slice :
         optimal_partition(wanted.subspan(run.begin, run.end - run.begin), run.cost)) {
      const OrderIndex begin = run.begin + slice.begin, size = slice.end - slice.begin;
      const auto paces = rates.empty() || size == 1
                             ? std::vector<Slice>{{0, size}}
                             : partition_by_pace(wanted.subspan(begin, size),
                                                 rates.subspan(begin, size), run.cost);
      for (const Slice pace : paces)
        add_group(grouping, {index, run.device, begin + pace.begin, begin + pace.end});
    }
  }
  for (const Group& pack : layout.packs) add_group(grouping, pack);
  return grouping;
}

Layout make_layout(const ScheduleInput& input, GroupingRule rule) {
  Layout layout;
  layout.lists.resize(input.devices.size());
  layout.point_at = ordered(input.points);
  const auto size = static_cast<OrderIndex>(layout.point_at.size());
  for (OrderIndex begin = 0, end = 0; begin < size; begin = end) {
    const Point& head = input.points[layout.point_at[begin]];
    std::uint32_t last_item = 0;
    for (end = begin; end < size; ++end) {
      const Point& point = input.points[layout.point_at[end]];
      if (point.device != head.device || point.range.area != head.range.area) break;
      last_item = std::max(last_item, point.range.end());
    }
    const ReadCost cost(input.devices[head.device], head.range.area, input.line, input.silence,
                        last_item - head.range.first);
    layout.area_run_at.insert(layout.area_run_at.end(), end - begin,
                              static_cast<AreaRunIndex>(layout.area_runs.size()));
    layout.area_runs.push_back({head.device, head.range.area, cost, begin, end});
  }
  if (rule == GroupingRule::kLists) move_packs(input, layout);
  layout.index_of.resize(input.points.size());
  for (OrderIndex index = 0; index < layout.point_at.size(); ++index)
    layout.index_of[layout.point_at[index]] = index;
  return layout;
}

}  // namespace fieldcast
