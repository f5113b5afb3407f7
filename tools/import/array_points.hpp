// Expands an array of a list to one point for each element. Pure.
#pragma once

#include <vector>

#include "tools/import/address.hpp"
#include "tools/import/model.hpp"

namespace fieldcast::importing {

// Appends `count` points like `first` at consecutive addresses: NAME-0, NAME-1, .. Stops one point
// above kMaxPoints. REQUIRES: count > 0.
void append_array(std::vector<Point>& points, const Point& first, ModbusArea area,
                  std::uint32_t address, unsigned count);

}  // namespace fieldcast::importing
