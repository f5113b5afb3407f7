// Summary of a ReadPlan (read_plan.hpp) for users and stations. Plain value.
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
