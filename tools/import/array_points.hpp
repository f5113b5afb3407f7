// A list's array as one point for each element. Pure.
#pragma once

#include <vector>

#include "tools/import/address.hpp"
#include "tools/import/model.hpp"

namespace fieldcast::importing {

// Appends `count` points after the first one's pattern: NAME-0, NAME-1, .. behind each other in the
// area; it ends one point above kMaxPoints. REQUIRES: count > 0.
void append_array(std::vector<Point>& points, const Point& first, ModbusArea area,
                  std::uint32_t address, unsigned count);

}  // namespace fieldcast::importing
