// Checks whether the wire of a bus can carry the requested refreshes. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

struct Overload {
  double load = 0;  // planned: required multiple of the wire
  // Largest factor on a requested refresh, by the load or by a long read that delays it.
  double stretch = 1;
  std::optional<std::uint32_t> baud;  // next standard rate at which the plan fits; empty if none
};

inline constexpr double kHopelessLoad = 100;

// Empty if the plan fits. On-demand channels have no cost. REQUIRES: the loader validated `bus`.
[[nodiscard]] std::optional<Overload> overload_of(const BusSpec& bus, Duration response_time);

// The load if it is hopeless even with immediate responses.
[[nodiscard]] std::optional<double> hopeless_load_of(const BusSpec& bus);

// A refresh shorter than its own read counts as requested; the scheduler extends it.
[[nodiscard]] double asked_load(const ScheduleInput& input, Planner planner);

// One line: the consequence and the fix.
[[nodiscard]] std::string to_text(const Overload& overload);

// Remedies for an infeasible bus: the nearest feasible configurations. Pure functions.
struct SlowerPoints {
  Duration from{}, to{};
  std::vector<PointIndex> points;
};

struct Remedies {
  std::optional<double> stretch;      // factor on all refreshes
  std::optional<std::uint32_t> baud;  // next standard rate
  // Longer refreshes of the fastest points, as far as needed; all of them apply together.
  std::vector<SlowerPoints> slower;
  bool longer_reads = false;         // devices without their configured max-block and max-gap
  bool no_pause = false;             // devices without their pause
  std::optional<std::size_t> buses;  // number of lines of this kind for the devices
};

// at_rate() is empty if the line is as fast already.
[[nodiscard]] ScheduleInput stretched(const ScheduleInput& input, double factor);
inline constexpr std::array<std::uint32_t, 10> kStandardRates{
    2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};
[[nodiscard]] std::optional<ScheduleInput> at_rate(const ScheduleInput& input, std::uint32_t baud);

// `works`: returns true if the bus keeps every refresh. `load`: start value of the search.
using Works = std::function<bool(const ScheduleInput&)>;
[[nodiscard]] Remedies find_remedies(const ScheduleInput& input, const Works& works, double load,
                                     Planner planner);

}  // namespace fieldcast
