// Finds values that overlap partly: one of the two is wrong, usually in its type or address. Pure.
#pragma once

#include <optional>
#include <vector>

#include "tools/import/points/address.hpp"
#include "tools/import/points/model.hpp"

namespace fieldcast::importing {

struct Placed {
  std::optional<std::uint16_t> device;  // only values of the same device are compared
  ModbusArea area = ModbusArea::kHolding;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;
  unsigned registers = 1;
  Point* point = nullptr;
};

// Adds a note to each value that shares some registers, or the same bit, with a different value.
// Bits in a register, and two values of exactly the same registers, are allowed.
void note_overlaps(std::vector<Placed> values);

}  // namespace fieldcast::importing
