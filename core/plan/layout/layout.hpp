// Order of the points of a bus, the cost to read them, and which are read together.
//
// Points are ordered by device, area and address, followed by the packs; an OrderIndex is an index
// in this order. A *group* is a run of points in this order that share requests; one request can
// read all of it.
// - With one range per request, a group is a block of the optimal partition of an area. It never
//   spans a gap that costs more than another request. Points with different rates are split further
//   (pace.hpp).
// - With a list of ranges per request, a group is a pack (pack.hpp): points of any areas of one
//   device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/plan/layout/cost.hpp"
#include "core/plan/layout/partition.hpp"

namespace fieldcast {

using OrderIndex = std::uint32_t;
using GroupIndex = std::uint32_t;
using AreaRunIndex = std::uint32_t;

struct AreaRun {
  DeviceIndex device = 0;
  AreaIndex area = 0;
  ReadCost cost;                  // as learned
  OrderIndex begin = 0, end = 0;  // of the points that are not in packs
};

struct Group {
  AreaRunIndex area_run = 0;  // of its first point
  DeviceIndex device = 0;
  OrderIndex begin = 0, end = 0;
  bool list = false;  // a pack, read by lists of ranges
  friend bool operator==(const Group&, const Group&) = default;
};

// Fixed for the life of a bus, except for the learned costs.
struct Layout {
  std::vector<AreaRun> area_runs;
  std::vector<Group> packs;
  std::vector<std::optional<ListCost>> lists;  // by device, if it has packs
  std::vector<PointIndex> point_at;            // by OrderIndex
  std::vector<OrderIndex> index_of;            // by PointIndex
  std::vector<AreaRunIndex> area_run_at;       // by OrderIndex
};

struct Grouping {
  std::vector<Group> groups;
  std::vector<GroupIndex> group_at;                // by OrderIndex
  std::vector<std::vector<GroupIndex>> groups_of;  // by device
  friend bool operator==(const Grouping&, const Grouping&) = default;
};

enum class GroupingRule : std::uint8_t { kLists, kSingleRanges, kSinglePoints };

// REQUIRES: points name devices of the input and areas of their protocols.
[[nodiscard]] Layout make_layout(const ScheduleInput& input, GroupingRule rule);

// `wanted`: items of each point, by OrderIndex. `rates`: reads per second of each point; empty to
// read all near points together.
[[nodiscard]] Grouping make_groups(const Layout& layout, std::span<const Wanted> wanted,
                                   std::span<const double> rates);

}  // namespace fieldcast
