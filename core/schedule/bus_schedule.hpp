// What the bus engine asks of its scheduler: one place for the engine, `fieldcast plan` and the simulation, so that what is
// predicted is what will run. Pure functions.
#pragma once

#include <span>
#include <vector>

#include "core/model/spec.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

// Silence that is kept after each answer. A plain TCP device needs none between frames; a serial server's line does.
[[nodiscard]] Duration silence_for(const BusSpec& bus);

// `protocols`: one for each device, outliving the input. A bus with room is planned with a longer lead, so that a broken answer
// can be asked for again in time.
[[nodiscard]] ScheduleInput schedule_input(const BusSpec& bus, std::span<const Protocol* const> protocols,
                                           std::vector<Point> points, Duration answer_time);

}  // namespace fieldcast
