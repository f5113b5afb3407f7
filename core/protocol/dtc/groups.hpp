// The groups of a DTC request, found again in its bytes (message.hpp has their layout). Pure.
#pragma once

#include "core/base/bytes.hpp"

namespace fieldcast::dtc {

// The group at the beginning of `bytes`: its size with data, or 0 when no group is complete there.
[[nodiscard]] std::size_t group_size(ByteView bytes, bool with_data);

// All its variables exist. REQUIRES: group_size() found one.
[[nodiscard]] bool inside(ByteView group);

// Nothing in a message says whether it is a request; groups that fill it to the last byte do. The
// data of a read's answer may look like groups by chance, but hardly like groups that exist.
[[nodiscard]] bool all_groups(ByteView bytes, bool with_data);

}  // namespace fieldcast::dtc
