// The plan of a bus: which points are read together, when, and the required wire time. An immutable
// value, made by a planner (planner.hpp) on any thread; a dispatcher (core/dispatch) executes it.
//
// A *group* is a set of points that share requests. Time is divided into *slots* of equal length. A
// group is read in every n-th slot: n slots are its *period*, and the first of these slots is its
// *phase*. Each point also has a period, a multiple of its group's, and takes part in every m-th
// read of the group. The plan repeats after the *hyperperiod*.
//
// An example: slots of 94 ms, a hyperperiod of 4 slots. Group A has a fast point a (refresh 100 ms)
// and two slow ones, b and c (refresh 400 ms). Group B has one point, d (refresh 200 ms).
//
//   slot        0        1        2        3        0 ..
//             |--------|--------|--------|--------|--------|
//   group A   |[ab]    |[a]     |[ac]    |[a]     |[ab]    |   period 1, phase 0
//   group B   |        |   [d]  |        |   [d]  |        |   period 2, phase 1
//
//   point a: period 1, phase 0      point b: period 4, phase 0
//   point d: period 2, phase 1      point c: period 4, phase 2
//
// b and c are in different slots to keep slots short. d ends at the same time within each of its
// slots, after the reads of group A. Slots are slightly shorter than the fastest refresh: a read
// that ends late by less than the difference is still in time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/plan/layout/layout.hpp"
#include "core/plan/timetable.hpp"

namespace fieldcast {

struct PlannedGroup {
  // Zero if not in the timetable: the group's reads follow its most urgent point.
  Duration period{};
  Duration phase{};  // from the start of the table to the end of a response, at the latest
  Duration slack{};  // how much earlier than planned its reads may end
  double load = 0;   // share of the wire
  friend bool operator==(const PlannedGroup&, const PlannedGroup&) = default;
};

struct PointPlan {
  double stretch = 1;               // factor on its refresh under overload
  Duration period{};                // zero if not in the timetable
  Duration phase{};                 // from the start of the table to one of its acquisitions
  Slots first_slot = 0, every = 0;  // the slots in which it is read
  // Longest planned time between two acquisitions; empty if it has no period, or is not read.
  std::optional<Duration> worst_gap;
  friend bool operator==(const PointPlan&, const PointPlan&) = default;
};

struct ReadPlan {
  // By device, area and address; a group is a run of them.
  std::vector<PointIndex> order;
  Grouping grouping;
  std::vector<PlannedGroup> groups;  // as in `grouping`
  std::vector<PointPlan> points;     // in the order of `order`
  // Slots of the requests; empty for a plan without a timetable.
  std::optional<Timetable> table;

  double load = 0;       // share of the wire for the requested refreshes; above 1: overload
  double fit = 1;        // factor on `load` that the timetable needs
  double stretch = 1;    // maximum of all points
  double demand = 0;     // load and overrun that the plan was made for
  double lightness = 1;  // 0 on a fully loaded wire, 1 on a lightly loaded one
  double margin = 0;     // part by which the base period is shorter than `fastest`
  Duration fastest{1};   // smallest allowed gap of all scheduled points

  [[nodiscard]] Duration slot() const { return table ? table->slot() : Duration::zero(); }
  [[nodiscard]] Duration hyperperiod() const {
    return table ? table->hyperperiod() : Duration::zero();
  }
  // The last planned end of a response with this point up to `until`, from the start of the table.
  // `tail`: from the end of a response until the wire is free. REQUIRES: the point has a period.
  [[nodiscard]] Duration last_acquisition(OrderIndex point, Duration tail, Duration until) const {
    const PointPlan& planned = points[point];
    return table->last_end(grouping.group_at[point], planned.first_slot, planned.every,
                           until + tail) -
           tail;
  }
  // Includes the cost of whole slots.
  [[nodiscard]] double planned_load() const { return load * fit; }
  friend bool operator==(const ReadPlan&, const ReadPlan&) = default;
};

// Summary of a ReadPlan (read_plan.hpp) for users and stations. Plain value.
struct PlanReport {
  struct Point {
    std::string area;  // "holding"
    std::uint32_t first = 0, count = 0;
    std::vector<std::string> channels;  // names on the device
    Duration period{}, phase{};         // zero if not in the timetable
    std::optional<Duration> worst_gap;  // between two acquisitions, as planned
    double stretch = 1;                 // factor on its refresh under overload
    friend bool operator==(const Point&, const Point&) = default;
  };
  struct Group {
    std::string device;
    bool list = false;           // a request contains a list of ranges
    Duration period{}, phase{};  // zero if not in the timetable
    Duration slack{};            // how much a read may end earlier than its phase
    double load = 0;             // share of the wire
    std::vector<Point> points;   // ordered by area and address
    friend bool operator==(const Group&, const Group&) = default;
  };
  double load = 0;                 // share of the wire that the plan needs
  double stretch = 1;              // maximum of all points
  Duration slot{}, hyperperiod{};  // zero without a timetable
  std::vector<Group> groups;
  friend bool operator==(const PlanReport&, const PlanReport&) = default;
};

struct PlanNames {
  std::function<std::string_view(DeviceIndex)> device;
  std::function<std::string_view(DeviceIndex, AreaIndex)> area;
  std::function<std::vector<std::string>(PointIndex)> channels;
};
// REQUIRES: the plan was made for these points.
[[nodiscard]] PlanReport report_of(const ReadPlan& plan, const std::vector<Point>& points,
                                   const PlanNames& names);

}  // namespace fieldcast
