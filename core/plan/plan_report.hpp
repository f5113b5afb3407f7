// What a plan looks like from outside: which channels are read together, and when. For people and
// for stations; made from a ReadPlan (read_plan.hpp), whose words it uses. A plain value.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/plan/read_plan.hpp"

namespace fieldcast {

struct PlanReport {
  // A range of items that is read for one or more channels.
  struct Point {
    std::string area;  // "holding"
    std::uint32_t first = 0, count = 0;
    std::vector<std::string> channels;  // names on the device
    Duration period{}, phase{};         // zero: it is not in the timetable
    std::optional<Duration> worst_gap;  // between two acquisitions, on the wire as planned
    double stretch = 1;                 // factor on its refresh under overload
    friend bool operator==(const Point&, const Point&) = default;
  };
  // Points that share requests.
  struct Group {
    std::string device;
    bool list = false;           // a request carries a list of ranges
    Duration period{}, phase{};  // zero: it is not in the timetable
    Duration slack{};            // by how much a read may end earlier than its phase says
    double load = 0;             // share of the wire
    std::vector<Point> points;   // in the order of areas and addresses
    friend bool operator==(const Group&, const Group&) = default;
  };
  double load = 0;                 // share of the wire that the plan needs
  double stretch = 1;              // the greatest of all points
  Duration slot{}, hyperperiod{};  // zero: a plan without a timetable
  std::vector<Group> groups;
  friend bool operator==(const PlanReport&, const PlanReport&) = default;
};

// Names of what a plan knows by index.
struct PlanNames {
  std::function<std::string_view(DeviceIndex)> device;
  std::function<std::string_view(DeviceIndex, AreaIndex)> area;
  std::function<std::vector<std::string>(PointIndex)> channels;
};
// REQUIRES: the plan was made for these points.
[[nodiscard]] PlanReport report_of(const ReadPlan& plan, const std::vector<Point>& points,
                                   const PlanNames& names);

}  // namespace fieldcast
