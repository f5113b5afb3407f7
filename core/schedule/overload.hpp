// Whether the wire of a bus can carry what its channels ask for: the check of a configuration
// before anything runs. Pure functions; they make no plan of a lightly loaded bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/spec.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

struct Overload {
  double load = 0;     // planned: how many times the wire would be needed
  double stretch = 1;  // the most that a refresh will be longer than asked for
  // The next standard rate whose wire has time for all of it; nothing: none, or no line. A plan
  // may need a higher one, where a long read is in the way of a short refresh.
  std::optional<std::uint32_t> baud;
};

// Beyond this load a bus is refused: every refresh would be a hundred times as long as asked for.
inline constexpr double kHopelessLoad = 100;

// Nothing if the plan fits, with devices that answer after `answer_time`. Channels that are read
// only when somebody asks cost nothing. REQUIRES: bus is as the loader makes it.
[[nodiscard]] std::optional<Overload> overload_of(const BusSpec& bus, Duration answer_time);

// The load, if it is hopeless even with devices that answer at once.
[[nodiscard]] std::optional<double> hopeless_load_of(const BusSpec& bus);

// The load of a plan in which a refresh shorter than its own read counts as it is asked for; to a
// scheduler it is as long as that read.
[[nodiscard]] double asked_load(const ScheduleInput& input, Planner planner);

// One line: what will happen, and how to mend it.
[[nodiscard]] std::string to_text(const Overload& overload);

}  // namespace fieldcast
