// Groups in the bytes of a DTC request; see message.hpp for their layout. Pure.
#pragma once

#include "core/base/bytes.hpp"

namespace fieldcast::dtc {

// 0 if it is incomplete.
[[nodiscard]] std::size_t group_size(ByteView bytes, bool with_data);

// REQUIRES: group_size() found one.
[[nodiscard]] bool inside(ByteView group);

// Returns true if existing groups fill the bytes exactly, which rarely happens in a read response.
[[nodiscard]] bool all_groups(ByteView bytes, bool with_data);

}  // namespace fieldcast::dtc
