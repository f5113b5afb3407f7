#include "core/schedule/layout.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/plan/partition.hpp"

namespace fieldcast {

void cut_into_clusters(std::span<const Wanted> wanted, Layout& layout) {
  layout.clusters.clear();
  layout.cluster_at.clear();
  for (auto& clusters : layout.clusters_of) clusters.clear();
  for (StripIndex index = 0; index < layout.strips.size(); ++index) {
    const Strip& strip = layout.strips[index];
    for (const Slice slice : optimal_partition(wanted.subspan(strip.begin, strip.end - strip.begin), strip.cost)) {
      const auto cluster = static_cast<ClusterIndex>(layout.clusters.size());
      layout.clusters.push_back({index, strip.device, strip.begin + slice.begin, strip.begin + slice.end});
      layout.clusters_of[strip.device].push_back(cluster);
      layout.cluster_at.insert(layout.cluster_at.end(), slice.end - slice.begin, cluster);
    }
  }
}

Layout make_layout(const ScheduleInput& input, Clustering clustering) {
  Layout layout;
  layout.clusters_of.resize(input.devices.size());
  layout.point_at.resize(input.points.size());
  std::iota(layout.point_at.begin(), layout.point_at.end(), PointIndex{0});
  std::sort(layout.point_at.begin(), layout.point_at.end(), [&](PointIndex a, PointIndex b) {
    const Point &p = input.points[a], &q = input.points[b];
    return std::tuple(p.device, p.range.area, p.range.first, p.range.end(), a) <
           std::tuple(q.device, q.range.area, q.range.first, q.range.end(), b);
  });
  layout.place_of.resize(input.points.size());
  for (Place place = 0; place < layout.point_at.size(); ++place) layout.place_of[layout.point_at[place]] = place;

  const auto size = static_cast<Place>(layout.point_at.size());
  for (Place begin = 0, end = 0; begin < size; begin = end) {
    const Point& head = input.points[layout.point_at[begin]];
    std::uint32_t last_item = 0;
    for (end = begin; end < size; ++end) {
      const Point& point = input.points[layout.point_at[end]];
      if (point.device != head.device || point.range.area != head.range.area) break;
      last_item = std::max(last_item, point.range.end());
    }
    const ReadCost cost(input.devices[head.device], head.range.area, input.line, input.silence, last_item - head.range.first);
    layout.strips.push_back({head.device, head.range.area, cost, begin, end});
  }
  std::vector<Wanted> wanted;
  for (const PointIndex point : layout.point_at) {
    const Range& range = input.points[point].range;
    wanted.push_back({range.first, range.end(), clustering == Clustering::kSinglePoints});
  }
  cut_into_clusters(wanted, layout);
  return layout;
}

}  // namespace fieldcast
