// Checks whether the wire of a bus can carry the requested refreshes. Pure functions; they make no
// plan of a lightly loaded bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/bus_spec.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

struct Overload {
  double load = 0;     // planned: required multiple of the wire
  double stretch = 1;  // largest factor on a requested refresh
  // Next standard rate with enough wire time; empty if none. A plan may need a higher one.
  std::optional<std::uint32_t> baud;
};

inline constexpr double kHopelessLoad = 100;

// Empty if the plan fits. On-demand channels have no cost. REQUIRES: the loader validated `bus`.
[[nodiscard]] std::optional<Overload> overload_of(const BusSpec& bus, Duration answer_time);

// The load if it is hopeless even with immediate responses.
[[nodiscard]] std::optional<double> hopeless_load_of(const BusSpec& bus);

// A refresh shorter than its own read counts as requested; the scheduler extends it.
[[nodiscard]] double asked_load(const ScheduleInput& input, Planner planner);

// One line: the consequence and the fix.
[[nodiscard]] std::string to_text(const Overload& overload);

}  // namespace fieldcast
