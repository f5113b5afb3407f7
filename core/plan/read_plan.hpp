// The plan of a bus: which points are read together, when, and what that will take. A value: a
// planner (planner.hpp) makes it on any thread, it is compared and printed, and nothing that runs
// it changes it. A dispatcher (core/dispatch) turns it into reads.
//
// A *group* is a set of points that share requests. The plan divides time into *slots* of equal
// length. A group is read in every n-th slot: n slots are its *period*. Which of those n slots it
// takes is its *phase*. The same holds for each of its points: a slower point has a longer period,
// a multiple of its group's, and takes part in every m-th read of the group. After the
// *hyperperiod* everything repeats.
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
// b and c are in different slots so that no slot is longer than needed. d ends at the same instant
// of each of its slots, behind the reads of group A. Slots are a little shorter than the fastest
// refresh: a read that ends late by less than the difference is still in time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/plan/layout.hpp"
#include "core/plan/timetable.hpp"

namespace fieldcast {

struct PlannedGroup {
  Duration period{};  // zero: not in the timetable; its reads follow its most urgent point
  Duration phase{};   // from the begin of the table to the end of the answer of one of its reads
  Duration slack{};   // by how much a read may end earlier than its phase says
  double load = 0;    // share of the wire
  friend bool operator==(const PlannedGroup&, const PlannedGroup&) = default;
};

struct PointPlan {
  double stretch = 1;  // factor on its refresh under overload
  Duration period{};   // zero: it is not in the timetable
  Duration phase{};    // from the begin of the table to one of its acquisitions
  // The longest time between two acquisitions while the wire is as planned. Nothing: it has no
  // period, or is not read.
  std::optional<Duration> worst_gap;
  friend bool operator==(const PointPlan&, const PointPlan&) = default;
};

struct ReadPlan {
  // Points by device, area and address; a group is a run of them.
  std::vector<PointIndex> order;
  Grouping grouping;
  std::vector<PlannedGroup> groups;  // as in `grouping`
  std::vector<PointPlan> points;     // in the order of `order`
  // In which slots requests are sent. Nothing: a plan without a timetable.
  std::optional<Timetable> table;

  double load = 0;       // share of the wire for the refreshes asked for; above 1: overload
  double fit = 1;        // factor on `load`: what the timetable needs
  double stretch = 1;    // the greatest of all points
  double demand = 0;     // load and overrun that the plan was made for
  double lightness = 1;  // 0 on a crowded wire, 1 on a light one
  Duration fastest{1};   // smallest allowed gap of all scheduled points

  [[nodiscard]] Duration slot() const { return table ? table->slot() : Duration::zero(); }
  [[nodiscard]] Duration hyperperiod() const {
    return table ? table->hyperperiod() : Duration::zero();
  }
  // Share of the wire that the plan needs, with what whole slots cost.
  [[nodiscard]] double planned_load() const { return load * fit; }
  friend bool operator==(const ReadPlan&, const ReadPlan&) = default;
};

// For people: a line for the bus, one for each group, and one for each of its points.
[[nodiscard]] std::string to_text(const ReadPlan& plan);

}  // namespace fieldcast
