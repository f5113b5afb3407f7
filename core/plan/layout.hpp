// Where the points of a bus lie, what reading them costs, and which of them are read together.
//
// Points are put in order: by device, area and address, and behind them the packs. An *index* in
// that order is an OrderIndex. A *group* is a run of points in that order that share requests: it
// holds what one request can read at most.
//
// - Where a request carries one range, a group is a block of the optimal partition of an area.
//   Points further apart than another request costs, or than one request can carry, are never read
//   together. Points that are read at different rates are cut further (pace.hpp).
// - Where a request carries a list of ranges, a group is a pack (pack.hpp): points of any areas of
//   one device.
//
// Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/plan/cost.hpp"
#include "core/plan/list_cost.hpp"
#include "core/plan/partition.hpp"
#include "core/plan/point.hpp"

namespace fieldcast {

using OrderIndex = std::uint32_t;
using GroupIndex = std::uint32_t;
using AreaRunIndex = std::uint32_t;

// All points of one area of a device.
struct AreaRun {
  DeviceIndex device = 0;
  AreaIndex area = 0;
  ReadCost cost;                  // as far as learned
  OrderIndex begin = 0, end = 0;  // of the points that are not in packs
};

struct Group {
  AreaRunIndex area_run = 0;  // of its first point
  DeviceIndex device = 0;
  OrderIndex begin = 0, end = 0;
  bool list = false;  // a pack, read by lists of ranges
  friend bool operator==(const Group&, const Group&) = default;
};

// Fixed for the life of a bus, but for the costs, which are learned.
struct Layout {
  std::vector<AreaRun> area_runs;
  std::vector<Group> packs;
  std::vector<std::optional<ListCost>> lists;  // by device, where there are packs
  std::vector<PointIndex> point_at;            // by OrderIndex
  std::vector<OrderIndex> index_of;            // by PointIndex
  std::vector<AreaRunIndex> area_run_at;       // by OrderIndex
};

// The groups of a plan.
struct Grouping {
  std::vector<Group> groups;
  std::vector<GroupIndex> group_at;                // by OrderIndex
  std::vector<std::vector<GroupIndex>> groups_of;  // by device
  friend bool operator==(const Grouping&, const Grouping&) = default;
};

enum class GroupingRule : std::uint8_t { kLists, kSingleRanges, kSinglePoints };

// REQUIRES: points name devices of the input and areas of their protocols.
[[nodiscard]] Layout make_layout(const ScheduleInput& input, GroupingRule rule);

// Cuts the area runs into groups by their present costs. `wanted`: the items of each point, by
// OrderIndex. `rates`: how often each is read a second, or nothing, if all that is near is to be
// read together.
[[nodiscard]] Grouping make_groups(const Layout& layout, std::span<const Wanted> wanted,
                                   std::span<const double> rates);

}  // namespace fieldcast
