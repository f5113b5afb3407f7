// Remedies for an infeasible bus: the nearest feasible configurations. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/plan/planner.hpp"

namespace fieldcast {

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
