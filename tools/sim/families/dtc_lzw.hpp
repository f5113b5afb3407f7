// LZW over nibbles for the simulated DTC device, independent of the bridge's implementation.
#pragma once

#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::sim {

[[nodiscard]] Bytes dtc_compress(ByteView message);

// Empty if the codes do not decode to `length` bytes. REQUIRES: length <= 4096.
[[nodiscard]] std::optional<Bytes> dtc_expand(ByteView codes, std::size_t length);

}  // namespace fieldcast::sim
