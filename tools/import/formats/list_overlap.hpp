// Values of a list that lie on parts of the same registers: one of the two is wrong, most often by
// its type or its address. Pure.
#pragma once

#include <optional>
#include <vector>

#include "tools/import/address.hpp"
#include "tools/import/model.hpp"

namespace fieldcast::importing {

// A value of the list at its place.
struct Placed {
  std::optional<std::uint16_t> device;  // those of one are compared
  ModbusArea area = ModbusArea::kHolding;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;
  unsigned registers = 1;
  Point* point = nullptr;
};

// Each value that shares registers with another one of other limits, or a bit with another one,
// gets a note. Bits in a register, and two views of the same registers, are fine.
void note_overlaps(std::vector<Placed> values);

}  // namespace fieldcast::importing
