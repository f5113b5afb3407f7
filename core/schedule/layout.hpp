// Where the points of a bus lie: strips (the points of one device and area, by address) cut into
// clusters.
//
// A cluster is what one request can read at most. Where a request carries one range, that is a
// block of the optimal partition of the whole strip: points further apart than another request
// costs, or than one request can carry, are never read together. Those that are read at different
// paces are cut further (plan/pace.hpp). Where it carries a list of ranges, it is a pack
// (pack.hpp): points of any areas of one device. A scheduler looks at one cluster at a time. Owned
// by the scheduler.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/plan/cost.hpp"
#include "core/plan/list_cost.hpp"
#include "core/plan/partition.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

using Place =
    std::uint32_t;  // of a point, in the order of strips and addresses, behind them the packs
using ClusterIndex = std::uint32_t;
using StripIndex = std::uint32_t;

struct Strip {
  DeviceIndex device = 0;
  AreaIndex area = 0;
  ReadCost cost;
  Place begin = 0, end = 0;  // of the points that are not in packs
};

struct Cluster {
  StripIndex strip = 0;  // of its first point
  DeviceIndex device = 0;
  Place begin = 0, end = 0;
  bool list = false;  // a pack, read by lists of ranges
  friend bool operator==(const Cluster&, const Cluster&) = default;
};

struct Layout {
  std::vector<Strip> strips;
  std::vector<Cluster> clusters;
  std::vector<Cluster> packs;                  // those of `clusters` that are never cut anew
  std::vector<std::optional<ListCost>> lists;  // by device, where there are packs
  std::vector<PointIndex> point_at;            // by place
  std::vector<Place> place_of;                 // by point
  std::vector<StripIndex> strip_at;            // by place
  std::vector<ClusterIndex> cluster_at;        // by place
  std::vector<std::vector<ClusterIndex>> clusters_of;  // by device
};

enum class Clustering : std::uint8_t { kLists, kSingleRanges, kSinglePoints };

// REQUIRES: points name devices of the input and areas of their protocols.
[[nodiscard]] Layout make_layout(const ScheduleInput& input, Clustering clustering);

// Cuts the strips into clusters by their present costs; `wanted` is what each place holds. `rates`:
// how often each is read, or nothing, if all that is near is to be read together.
void cut_into_clusters(std::span<const Wanted> wanted, std::span<const double> rates,
                       Layout& layout);

}  // namespace fieldcast
