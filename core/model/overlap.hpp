// Channels of one device that read the same items as different things: usually a slip of one in an
// address. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/model/spec.hpp"

namespace fieldcast {

struct Overlap {
  const DeviceSpec* device = nullptr;
  const ChannelSpec* first = nullptr;  // the one with the lower address
  const ChannelSpec* second = nullptr;
};

// For each channel at most one other, whose items lie before or on its own. Left out: bits and
// bytes of items, which are meant as parts of a whole, and two names for one value (the same items
// in the same type). The pointers lead into `bus`.
[[nodiscard]] std::vector<Overlap> overlaps_of(const BusSpec& bus);

// "press-1/a (holding:100, uint32) and press-1/b (holding:101, uint32) overlap in another type".
[[nodiscard]] std::string to_text(const Overlap& overlap);

}  // namespace fieldcast
