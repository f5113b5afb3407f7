// The input of the scheduler of a bus. The bus engine, `fieldcast plan` and the simulation all get
// it here, so that what is predicted is what will run. Pure functions.
#pragma once

#include <span>
#include <vector>

#include "core/model/spec.hpp"
#include "core/plan/planner.hpp"

namespace fieldcast {

// The answer time that is assumed of every device until its own is learned: from the end of a
// request to the first byte of the answer.
inline constexpr Duration kAssumedAnswerTime = std::chrono::milliseconds{5};

// Silence that is kept after each answer. A plain TCP device needs none between frames; a serial
// server's line does.
[[nodiscard]] Duration silence_for(const BusSpec& bus);

// What a bus asks of its wire, with the shortest lead. `protocols`: one for each device, outliving
// the input.
[[nodiscard]] ScheduleInput wire_input(const BusSpec& bus,
                                       std::span<const Protocol* const> protocols,
                                       std::vector<Point> points, Duration answer_time);

// The same as it will run: a lightly loaded bus is planned with a longer lead, so that a broken
// answer can be asked for again in time.
[[nodiscard]] ScheduleInput schedule_input(const BusSpec& bus,
                                           std::span<const Protocol* const> protocols,
                                           std::vector<Point> points, Duration answer_time);

}  // namespace fieldcast
