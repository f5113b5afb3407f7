// What would make a bus feasible that is not: the nearest configurations that work. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/plan/planner.hpp"

namespace fieldcast {

// Points of one refresh and the refresh that they would need.
struct SlowerPoints {
  Duration from{}, to{};
  std::vector<PointIndex> points;
};

// The nearest configurations that work; nothing where none was found.
struct Remedies {
  std::optional<double> stretch;      // all refreshes longer by this factor
  std::optional<std::uint32_t> baud;  // the next standard rate
  // Slower refreshes of the fastest points alone, as far as needed: all of these together.
  std::vector<SlowerPoints> slower;
  bool longer_reads = false;  // devices without the max-block and max-gap that are configured
  bool no_pause = false;      // devices without their pause
  std::optional<std::size_t> buses;  // the devices spread over so many lines of this kind
};

// The same with every refresh longer by the factor; on a faster line (nothing: it is as fast
// already).
[[nodiscard]] ScheduleInput stretched(const ScheduleInput& input, double factor);
inline constexpr std::array<std::uint32_t, 10> kStandardRates{
    2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};
[[nodiscard]] std::optional<ScheduleInput> at_rate(const ScheduleInput& input, std::uint32_t baud);

// `works`: whether a bus like this keeps every refresh. `load`: what the input asks of its wire;
// the search for a stretch begins there.
using Works = std::function<bool(const ScheduleInput&)>;
[[nodiscard]] Remedies find_remedies(const ScheduleInput& input, const Works& works, double load,
                                     Planner planner);

}  // namespace fieldcast
