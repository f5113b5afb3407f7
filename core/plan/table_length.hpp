// Computes the length of a timetable and its slots, and the periods that fit. Pure functions.
#pragma once

#include <span>

#include "core/plan/timetable.hpp"

namespace fieldcast {

// Each member is read at the longest period that fits its allowed gap and divides the table.
[[nodiscard]] TableLength table_length(std::span<const TimetableRequest> requests);

void set_periods(TimetableRequest& request, const TableLength& length);

}  // namespace fieldcast
