// Finds channels with overlapping items of different types: usually an address off by one.
#pragma once

#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"

namespace fieldcast {

struct Overlap {
  const DeviceSpec* device = nullptr;
  const ChannelSpec* first = nullptr;  // the one with the lower address
  const ChannelSpec* second = nullptr;
};

// At most one overlap per channel; without bits, bytes and second names. Points into `bus`.
[[nodiscard]] std::vector<Overlap> overlaps_of(const BusSpec& bus);

// "press-1/a (holding:100, uint32) and press-1/b (holding:101, uint32) overlap in another type".
[[nodiscard]] std::string to_text(const Overlap& overlap);

}  // namespace fieldcast
