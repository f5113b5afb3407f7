#pragma once

#include <vector>

#include "tools/import/points/address.hpp"
#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

// Appends points at consecutive addresses: NAME-0, NAME-1, .. Stops one point above kMaxPoints.
// REQUIRES: count > 0. Pure.
void append_array(std::vector<Point>& points, const Point& first, ModbusArea area,
                  std::uint32_t address, unsigned count);

}  // namespace fieldcast::importing
