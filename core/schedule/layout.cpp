#include "core/schedule/layout.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/plan/pace.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/pack.hpp"

namespace fieldcast {

namespace {

void add_cluster(Layout& layout, const Cluster& cluster) {
  layout.cluster_at.insert(layout.cluster_at.end(), cluster.end - cluster.begin,
                           static_cast<ClusterIndex>(layout.clusters.size()));
  layout.clusters_of[cluster.device].push_back(static_cast<ClusterIndex>(layout.clusters.size()));
  layout.clusters.push_back(cluster);
}

std::vector<Wanted> wanted_of(const ScheduleInput& input, std::span<const PointIndex> points,
                              bool single) {
  std::vector<Wanted> wanted;
  wanted.reserve(points.size());
  for (const PointIndex point : points) {
    const Range& range = input.points[point].range;
    wanted.push_back({range.first, range.end(), single});
  }
  return wanted;
}

// Takes the points of one device that are read by lists out of its strips: false for those in
// `stays`.
std::vector<std::vector<PointIndex>> packs_of(const ScheduleInput& input, const Layout& layout,
                                              DeviceIndex device, std::vector<bool>& stays) {
  const ListCost& cost = *layout.lists[device];
  std::vector<StripPoints> strips;
  for (const Strip& strip : layout.strips) {
    if (strip.device != device || !cost.lists(strip.area)) continue;
    strips.push_back(
        {std::span(layout.point_at).subspan(strip.begin, strip.end - strip.begin), strip.cost});
  }
  auto packs = make_packs(input.points, strips, cost);
  for (const auto& pack : packs) {
    for (const PointIndex point : pack) stays[point] = false;
  }
  return packs;
}

// Moves what is read by lists behind all strips.
void pack(const ScheduleInput& input, Layout& layout) {
  std::vector<bool> stays(input.points.size(), true);
  std::vector<std::pair<DeviceIndex, std::vector<PointIndex>>> packs;
  for (DeviceIndex device = 0; device < input.devices.size(); ++device) {
    if (!ListCost::can_list(*input.devices[device].protocol)) continue;
    layout.lists[device].emplace(input.devices[device], input.line, input.silence);
    for (auto& points : packs_of(input, layout, device, stays))
      packs.emplace_back(device, std::move(points));
  }
  if (packs.empty()) return;
  std::vector<StripIndex> strip_of(input.points.size());
  for (Place place = 0; place < layout.point_at.size(); ++place)
    strip_of[layout.point_at[place]] = layout.strip_at[place];
  std::vector<PointIndex> point_at;
  for (Strip& strip : layout.strips) {
    const auto begin = static_cast<Place>(point_at.size());
    for (Place place = strip.begin; place < strip.end; ++place) {
      if (stays[layout.point_at[place]]) point_at.push_back(layout.point_at[place]);
    }
    strip.begin = begin;
    strip.end = static_cast<Place>(point_at.size());
  }
  for (const auto& [device, points] : packs) {
    const auto begin = static_cast<Place>(point_at.size());
    point_at.insert(point_at.end(), points.begin(), points.end());
    layout.packs.push_back(
        {strip_of[points.front()], device, begin, static_cast<Place>(point_at.size()), true});
  }
  layout.point_at = std::move(point_at);
  for (Place place = 0; place < layout.point_at.size(); ++place)
    layout.strip_at[place] = strip_of[layout.point_at[place]];
}

}  // namespace

void cut_into_clusters(std::span<const Wanted> wanted, std::span<const double> rates,
                       Layout& layout) {
  layout.clusters.clear();
  layout.cluster_at.clear();
  for (auto& clusters : layout.clusters_of) clusters.clear();
  for (StripIndex index = 0; index < layout.strips.size(); ++index) {
    const Strip& strip = layout.strips[index];
    for (const Slice slice :
         optimal_partition(wanted.subspan(strip.begin, strip.end - strip.begin), strip.cost)) {
      const Place begin = strip.begin + slice.begin, size = slice.end - slice.begin;
      const auto paces = rates.empty() || size == 1
                             ? std::vector<Slice>{{0, size}}
                             : partition_by_pace(wanted.subspan(begin, size),
                                                 rates.subspan(begin, size), strip.cost);
      for (const Slice pace : paces)
        add_cluster(layout, {index, strip.device, begin + pace.begin, begin + pace.end});
    }
  }
  for (const Cluster& pack : layout.packs) add_cluster(layout, pack);
}

Layout make_layout(const ScheduleInput& input, Clustering clustering) {
  Layout layout;
  layout.clusters_of.resize(input.devices.size());
  layout.lists.resize(input.devices.size());
  layout.point_at.resize(input.points.size());
  std::iota(layout.point_at.begin(), layout.point_at.end(), PointIndex{0});
  std::sort(layout.point_at.begin(), layout.point_at.end(), [&](PointIndex a, PointIndex b) {
    const Point &p = input.points[a], &q = input.points[b];
    return std::tuple(p.device, p.range.area, p.range.first, p.range.end(), a) <
           std::tuple(q.device, q.range.area, q.range.first, q.range.end(), b);
  });

  const auto size = static_cast<Place>(layout.point_at.size());
  for (Place begin = 0, end = 0; begin < size; begin = end) {
    const Point& head = input.points[layout.point_at[begin]];
    std::uint32_t last_item = 0;
    for (end = begin; end < size; ++end) {
      const Point& point = input.points[layout.point_at[end]];
      if (point.device != head.device || point.range.area != head.range.area) break;
      last_item = std::max(last_item, point.range.end());
    }
    const ReadCost cost(input.devices[head.device], head.range.area, input.line, input.silence,
                        last_item - head.range.first);
    layout.strip_at.insert(layout.strip_at.end(), end - begin,
                           static_cast<StripIndex>(layout.strips.size()));
    layout.strips.push_back({head.device, head.range.area, cost, begin, end});
  }
  if (clustering == Clustering::kLists) pack(input, layout);
  layout.place_of.resize(input.points.size());
  for (Place place = 0; place < layout.point_at.size(); ++place)
    layout.place_of[layout.point_at[place]] = place;
  std::vector<double> rates;
  if (clustering == Clustering::kLists) {
    for (const PointIndex point : layout.point_at)
      rates.push_back(1 / std::max(1e-9, to_seconds(input.points[point].refresh)));
  }
  cut_into_clusters(wanted_of(input, layout.point_at, clustering == Clustering::kSinglePoints),
                    rates, layout);
  return layout;
}

}  // namespace fieldcast
