// How many slots a timetable has, how long they are, and which periods fit into it. Pure functions.
#pragma once

#include <span>

#include "core/plan/timetable.hpp"

namespace fieldcast {

// The length that wastes least of the wire: each member is read at the longest period that its
// allowed gap holds and that divides the table. `parts`: 2.5 base periods are 5 slots of a half.
[[nodiscard]] TableLength table_length(std::span<const TimetableRequest> requests);

// Gives a request and its members the longest periods that fit.
void set_periods(TimetableRequest& request, const TableLength& length);

}  // namespace fieldcast
